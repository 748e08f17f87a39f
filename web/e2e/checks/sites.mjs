// The list of sites, the overview map, and the page of a site.
import assert from 'node:assert/strict';

import { counted } from '../browser.mjs';

const drawn = (page) => page.waitForSelector('[data-overview="drawn"]', { timeout: 60_000 });

export const checks = {
  async 'the list shows before the code of the map is there, and leads to maps'(page, { address, sites, site, picture }) {
    let letCodeCome;
    const isAllowed = new Promise((resolve) => (letCodeCome = resolve));
    await page.route('**/overview_map-*.js', async (route) => {
      await isAllowed;
      await route.continue();
    });
    await page.goto(`${address}/sites`);
    const row = page.locator(`[data-site-row="${site.name}"]`);
    await row.waitFor();
    await counted(page.locator('[data-site-row]'), sites.length);
    await counted(page.locator('[data-overview="ahead"]'), 1);
    letCodeCome();
    await drawn(page);
    const placed = sites.filter(({ datum }) => datum).length;
    await counted(page.locator('a[data-site]'), placed, 'a label for each site on Earth');
    await picture('sites');
    await row.locator('a.main').click();
    await page.waitForURL(`**/sites/${site.name}/maps/latest`);
  },

  async 'search and filter are kept in the address'(page, { address, sites, site }) {
    await page.goto(`${address}/sites`);
    await page.getByLabel('Search sites').fill(site.name.toUpperCase());
    await page.locator(`[data-site-row="${site.name}"]`).waitFor();
    await page.getByLabel('Search sites').fill('no site is named like this');
    await page.getByText('No site is like that').waitFor();
    assert.equal(new URL(page.url()).searchParams.get('q'), 'no site is named like this');
    await page.reload();
    await page.getByText('No site is like that').waitFor();
    await page.getByRole('button', { name: 'Show all' }).click();
    await page.waitForFunction((count) => document.querySelectorAll('[data-site-row]').length === count, sites.length);
    await page.locator('select[aria-label="State"]').selectOption('no_map');
    await page.waitForFunction((count) => document.querySelectorAll('[data-site-row]').length === count, sites.filter((one) => one.latest_version === null).length);
  },

  async 'without WebGL the list works, and says what is missing'(page, { address, site }) {
    await page.addInitScript(() => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind.startsWith('webgl') ? null : getContext.call(this, kind, ...rest);
      };
    });
    await page.goto(`${address}/sites`);
    await page.getByRole('alert').filter({ hasText: 'WebGL' }).waitFor({ timeout: 60_000 });
    await page.locator(`[data-site-row="${site.name}"]`).waitFor();
    page.faults.length = 0; // MapLibre complains of it on the console, too
  },

  async 'a service that fails is said, and asked again'(page, { address, site }) {
    let isBroken = true;
    await page.route('**/api/v1/sites?*', (route) =>
      isBroken
        ? route.fulfill({ status: 503, contentType: 'application/problem+json', body: '{"detail":"the service is stopping"}' })
        : route.continue(),
    );
    await page.goto(`${address}/sites`);
    await page.getByRole('alert').filter({ hasText: 'The service is stopping' }).waitFor();
    isBroken = false;
    await page.getByRole('button', { name: 'Try again' }).click();
    await page.locator(`[data-site-row="${site.name}"]`).waitFor();
    page.faults.length = 0; // the browser notes each 503
  },

  async 'a site lists its versions, and compares neighbors'(page, world) {
    const { address, site, picture } = world;
    await page.goto(`${address}/sites/${site.name}`);
    await page.locator(`[data-version="${site.latest_version}"]`).waitFor();
    await counted(page.locator('[data-version]'), site.versions.length);
    await page.locator('[data-drive]').first().waitFor();
    await picture('site');
    if (site.versions.length < 2) world.skip('no site has two versions');
    const before = site.versions.filter((version) => version < site.latest_version).at(-1);
    const link = page.getByRole('link', { name: `Compare with ${before}` });
    assert.equal(await link.getAttribute('href'), `/sites/${site.name}/compare?from=${before}&to=${site.latest_version}`);
  },

  async 'settings are saved and refused with words'(page, { address, site, json }) {
    const { title } = await json.call({ address }, `/api/v1/sites/${site.name}`);
    await page.goto(`${address}/sites/${site.name}`);
    const form = page.getByRole('form', { name: 'Settings of the site' });
    await form.getByLabel('Title').fill('A title of the checks');
    await form.getByRole('button', { name: 'Save' }).click();
    await form.getByText('Saved').waitFor();
    await page.getByRole('heading', { level: 1, name: 'A title of the checks' }).waitFor();
    await form.getByLabel('Title').fill(title);
    await form.getByRole('button', { name: 'Save' }).click();
    await page.getByRole('heading', { level: 1, name: title || site.name, exact: true }).waitFor();
    await page.route(`**/api/v1/sites/${site.name}`, (route) =>
      route.request().method() === 'PUT'
        ? route.fulfill({ status: 400, contentType: 'application/problem+json', body: '{"detail":"there is no rig \'x\'"}' })
        : route.continue(),
    );
    await form.getByRole('button', { name: 'Save' }).click();
    await form.getByRole('alert').filter({ hasText: "There is no rig 'x'" }).waitFor();
    page.faults.length = 0; // the browser notes the 400
  },

  async 'a version is built from chosen drives'(page, world) {
    const { address, site } = world;
    const drives = world.drives.filter((drive) => drive.site === site.name && drive.log === 'stored');
    if (drives.length < 2) world.skip('no site has two drives');
    let body = null;
    await page.route(`**/api/v1/sites/${site.name}/maps`, (route) => {
      if (route.request().method() !== 'POST') return route.continue();
      body = route.request().postDataJSON();
      return route.fulfill({ status: 409, contentType: 'application/problem+json', body: '{"detail":"another job waits"}' });
    });
    await page.goto(`${address}/sites/${site.name}`);
    await page.getByRole('button', { name: 'Build a version' }).click();
    const dialog = page.getByRole('dialog');
    await dialog.getByLabel(drives[0].name, { exact: false }).first().uncheck();
    await dialog.getByLabel('Begin from').selectOption(String(site.latest_version));
    await dialog.getByRole('button', { name: /^Build from/ }).click();
    await dialog.getByRole('alert').filter({ hasText: 'Another job waits' }).waitFor();
    assert.equal(body.from, site.latest_version);
    assert.ok(!body.drives.includes(drives[0].id));
    page.faults.length = 0; // the browser notes the 409
  },

  async 'a site that is not there says so'(page, { address }) {
    await page.goto(`${address}/sites/no-such-site`);
    await page.getByRole('alert').filter({ hasText: 'no-such-site' }).first().waitFor();
    await page.getByRole('link', { name: 'All sites' }).first().waitFor();
    page.faults.length = 0; // the browser notes each 404
  },
};
