// Debian's Chromium for the tests of the page: one browser, a page for each case.
import assert from 'node:assert/strict';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';

import { chromium } from 'playwright-core';

const kArguments = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
  '--disable-background-networking', '--disable-component-update', '--disable-sync'];

const kPatience = 60_000; // [ms] a machine that compiles beside it takes its time

/** Opens a browser, whose profile goes with it. `context.newPage()` opens pages. */
export async function openBrowser(viewport = { width: 1280, height: 720 }) {
  const profile = await mkdtemp(path.join(tmpdir(), 'parkade-chromium-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    viewport,
    args: kArguments,
  });
  context.setDefaultTimeout(kPatience);
  return {
    context,
    async close() {
      await context.close();
      await rm(profile, { recursive: true, force: true });
    },
  };
}

/** A page that remembers what went wrong in it: exceptions, and errors on its console. */
export async function openPage(context, address) {
  const page = await context.newPage();
  page.faults = [];
  page.on('pageerror', (error) => page.faults.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') page.faults.push(`${message.text()} ${message.location().url}`);
  });
  // Playwright's own evaluates a text in the page, which the page's Content-Security-Policy forbids.
  page.waitForFunction = (predicate, argument, options) => until(page, predicate, argument, options);
  await page.goto(address);
  return page;
}

/** Waits until something is true in the page; a page that is being left is asked again. */
async function until(page, predicate, argument, { timeout = kPatience } = {}) {
  const end = Date.now() + timeout;
  for (;;) {
    const value = await page.evaluate(predicate, argument).catch((error) => {
      if (!/context was destroyed|navigat/i.test(String(error))) throw error;
    });
    if (value) return value;
    if (Date.now() > end) throw new Error(`never became true within ${timeout} ms: ${predicate}`);
    await page.waitForTimeout(50);
  }
}

/** Waits until a map's first ground is drawn: "lot/2". */
export const mapShown = (page, name) => page.locator(`body[data-shown="${name}"]`).waitFor({ state: 'attached' });

/** Waits until so many are there: what a page shows comes piece by piece. */
export async function counted(locator, expected, why) {
  const end = Date.now() + kPatience;
  while ((await locator.count()) !== expected && Date.now() < end) await locator.page().waitForTimeout(50);
  assert.equal(await locator.count(), expected, why);
}
