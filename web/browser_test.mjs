// Drives the viewer in headless Chromium: node browser_test.mjs URL [SCREENSHOT.png]
// The service at URL must have at least one drive with a map.
import assert from 'node:assert/strict';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';

import { chromium } from 'playwright-core';

const [url, screenshotPath = 'viewer.png'] = process.argv.slice(2);
assert(url, 'usage: node browser_test.mjs URL [SCREENSHOT.png]');

const profile = await mkdtemp(path.join(tmpdir(), 'parkade-chromium-'));
const browser = await chromium.launchPersistentContext(profile, {
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  viewport: { width: 1280, height: 800 },
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});

// Distinct colours in a screenshot of the canvas, counted by the browser itself.
async function countColors(page) {
  const png = (await page.locator('#canvas').screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const pixels = new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer);
    return new Set(pixels).size;
  }, png);
}

try {
  const page = await browser.newPage();
  const complaints = [];
  page.on('console', (line) => line.type() === 'error' && complaints.push(line.text()));
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('requestfailed', (request) => !request.url().endsWith('/events') && complaints.push(`${request.url()} failed`));

  await page.goto(url);
  await page.waitForSelector('body[data-shown]', { timeout: 60_000 });
  await page.waitForTimeout(500);
  await page.screenshot({ path: screenshotPath });

  assert.equal(await page.locator('.drive .state.ready').first().textContent(), 'ready');
  assert.match(await page.locator('#map-panel').innerText(), /m²/);
  const withGround = await countColors(page);
  assert(withGround > 500, `the canvas shows only ${withGround} colours`);

  await page.getByRole('button', { name: 'Ground' }).click();
  await page.waitForTimeout(300);
  const withoutGround = await countColors(page);
  assert(withoutGround < withGround / 2, `hiding the ground leaves ${withoutGround} of ${withGround} colours`);
  await page.getByRole('button', { name: 'Ground' }).click();
  await page.getByRole('button', { name: 'From above' }).click();
  await page.waitForTimeout(300);
  await page.screenshot({ path: screenshotPath.replace(/\.png$/, '_above.png') });

  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('link', { name: /^map\.glb/ }).click(),
  ]);
  assert.equal(await download.failure(), null);
  assert.deepEqual(complaints, []);
  console.log(`viewer: ${withGround} colours, no complaints, ${screenshotPath}`);
} finally {
  await browser.close();
  await rm(profile, { recursive: true, force: true });
}
