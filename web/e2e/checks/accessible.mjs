// axe finds nothing serious, in light and dark; and the keyboard alone leads through.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';

import { mapShown } from '../browser.mjs';
import { playRole } from '../roles.mjs';

const axeSource = await readFile(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const kTabs = ['info', 'time', 'loops', 'measure', 'review', 'pins', 'share'];

/** What axe calls serious or critical, a line each. Evaluated, not inserted: the page's policy lets no script in. */
async function findings(page, where) {
  await page.evaluate(axeSource);
  const found = [];
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme, reducedMotion: 'reduce' });
    // Colors are all that differs between the two.
    const options = colorScheme === 'light' ? { resultTypes: ['violations'] } : { resultTypes: ['violations'], runOnly: ['color-contrast'] };
    const violations = await page.evaluate(async (how) => (await globalThis.axe.run(document, how)).violations, options);
    for (const { id, impact, nodes } of violations)
      if (impact === 'serious' || impact === 'critical')
        found.push(...nodes.map(({ target, failureSummary }) => `${where} (${colorScheme}): ${id} at ${target.join(' ')}: ${failureSummary.split('\n').at(-1).trim()}`));
  }
  await page.emulateMedia({ colorScheme: 'light', reducedMotion: null });
  return found;
}

async function checkPlaces(page, address, paths) {
  const found = [];
  for (const path of paths) {
    await page.goto(address + path);
    await page.locator('main :is(h1, h2)').first().waitFor();
    await page.locator('main [role=status]', { hasText: '…' }).waitFor({ state: 'detached', timeout: 10_000 }).catch(() => {});
    found.push(...(await findings(page, path)));
  }
  assert.deepEqual(found, []);
}

export const checks = {
  async 'lists and their details'(page, { address, site, drives }) {
    const [jobs, rigs] = await Promise.all(['jobs', 'rigs'].map(async (list) => (await (await fetch(`${address}/api/v1/${list}`)).json()).items));
    await checkPlaces(page, address, [
      '/sites', `/sites/${site.name}`, '/drives', '/jobs', '/rigs', '/review', '/upload',
      ...drives.slice(0, 1).map(({ id }) => `/drives/${id}`),
      ...jobs.slice(0, 1).map(({ id }) => `/jobs/${id}`),
      ...rigs.slice(0, 1).map(({ name }) => `/rigs/${name}`),
    ]);
  },

  async 'settings, and the sign-in'(page, { address }) {
    await checkPlaces(page, address, ['/settings/access', '/settings/shares', '/settings/webhooks', '/settings/audit']);
    await playRole(page, { name: 'anne', role: 'admin' });
    await page.route('**/api/v1/tokens?*', (route) => route.fulfill({ json: { items: [], next_cursor: null } }));
    await page.goto(`${address}/settings/access`);
    await page.getByRole('button', { name: 'New token' }).click();
    await page.getByLabel('Some: all else').check();
    const found = await findings(page, 'new token');
    await page.unrouteAll({ behavior: 'ignoreErrors' });
    await page.route('**/api/v1/session', (route) => route.fulfill({ json: { access: 'token', caller: null, csrf: null } }));
    await page.goto(`${address}/sites`);
    await page.getByLabel('Your token').waitFor();
    assert.deepEqual([...found, ...(await findings(page, 'sign in'))], []);
  },

  async 'a map, tab by tab, and its keys'(page, { address, site }) {
    await page.goto(`${address}/sites/${site.name}/maps/latest`);
    await mapShown(page, `${site.name}/${site.latest_version}`);
    const found = [];
    for (const tab of kTabs) {
      await page.locator(`#tab-${tab}`).click();
      await page.locator(`#tab-${tab}[aria-selected=true]`).waitFor();
      await page.waitForTimeout(300); // what the panel asks the service for
      found.push(...(await findings(page, tab)));
    }
    await page.keyboard.press('?');
    await page.getByRole('dialog', { name: 'Keys' }).waitFor();
    found.push(...(await findings(page, 'keys')));
    assert.deepEqual(found, []);
  },

  async 'two versions compared'(page, { address, site, skip }) {
    if (site.versions.length < 2) skip('no site has two versions');
    const [from, to] = [...site.versions].sort((a, b) => a - b).slice(-2);
    await page.goto(`${address}/sites/${site.name}/compare?from=${from}&to=${to}`);
    await page.locator('main :is(h1, h2)').first().waitFor();
    await page.waitForTimeout(1000);
    assert.deepEqual(await findings(page, 'compare'), []);
  },

  async 'the keyboard alone leads from the sites to a map, through its tabs, and to the list of keys'(page, { address, sites }) {
    await page.goto(`${address}/sites`);
    const site = sites.find(({ latest_version }) => latest_version !== null);
    await page.locator(`main a[href^="/sites/${site.name}"]`).first().waitFor();
    // Wherever the list puts them: Tab comes to each link, and Enter follows it.
    const tabTo = async (selector) => {
      for (let i = 0; i < 80; i++) {
        await page.keyboard.press('Tab');
        if (await page.evaluate((wanted) => document.activeElement?.matches(wanted), selector)) return;
      }
      assert.fail(`Tab does not reach ${selector}`);
    };
    await tabTo(`main a[href^="/sites/${site.name}"]`);
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => location.pathname !== '/sites');
    if (!new URL(page.url()).pathname.includes('/maps/')) {
      const toMap = `main a[href^="/sites/${site.name}/maps/"]`;
      await page.locator(toMap).first().waitFor();
      await tabTo(toMap);
      await page.keyboard.press('Enter');
    }
    await page.locator('#tab-info').waitFor();
    await tabTo('[role=tab][aria-selected=true]');
    await page.keyboard.press('ArrowRight');
    await page.locator('#tab-time[aria-selected=true]').waitFor();
    assert.equal(await page.evaluate(() => document.activeElement.id), 'tab-time');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('ArrowLeft');
    await page.locator('#tab-share[aria-selected=true]').waitFor();
    await page.keyboard.press('?');
    await page.getByRole('dialog', { name: 'Keys' }).waitFor();
    await page.keyboard.press('Escape');
    await page.getByRole('dialog', { name: 'Keys' }).waitFor({ state: 'detached' });
    assert.equal(await page.evaluate(() => document.activeElement.id), 'tab-share', 'the focus is where it was');
  },
};
