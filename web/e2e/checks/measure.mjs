// Measuring: drawn in the picture, saved with the site, taken away as files.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';

import { mapShown } from '../browser.mjs';
import { clickGround, viewOfGround } from '../ground.mjs';

const numPoints = async (page) => Number(/^\d+/.exec(await page.locator('.drawing .hint').first().innerText())?.[0] ?? 0);

async function openMeasure(page, world) {
  const { address, site } = world;
  await page.goto(`${address}/sites/${site.name}/maps/${site.latest_version}?tab=measure&view=${await viewOfGround(world)}`);
  await mapShown(page, `${site.name}/${site.latest_version}`);
  await page.getByRole('button', { name: 'Distance', exact: true }).waitFor(); // its keys come with it
}

/** Removes what a check saved. */
async function removeAll(world, title) {
  const { address, site } = world;
  for (const { id, title: found } of (await world.json(`/api/v1/sites/${site.name}/measurements?limit=100`)).items)
    if (found === title) await fetch(`${address}/api/v1/sites/${site.name}/measurements/${id}`, { method: 'DELETE' });
}

export const checks = {
  async 'a distance is drawn, saved, shown, exported and deleted'(page, world) {
    const title = `check ${Date.now()}`;
    const { address, site } = world;
    await openMeasure(page, world);
    await page.getByRole('button', { name: 'Distance', exact: true }).click();
    await clickGround(page, async () => (await numPoints(page)) === 1);
    await clickGround(page, async () => (await numPoints(page)) === 2, [[0.56, 0.45], [0.55, 0.55], [0.44, 0.5], [0.45, 0.55]]);
    await clickGround(page, async () => (await numPoints(page)) === 3, [[0.45, 0.58], [0.44, 0.42], [0.55, 0.58], [0.6, 0.6]]);
    await page.keyboard.press('Backspace');
    await page.waitForFunction(() => document.querySelector('.drawing .hint')?.textContent?.startsWith('2'));
    await page.keyboard.press('Enter');
    await page.getByLabel('Title').fill(title);
    const shown = await page.locator('form .value').innerText();
    assert.match(shown, /^\d+\.\d\d m$/);
    await page.keyboard.press('Enter');

    const entry = page.getByRole('button', { name: title }).first();
    await entry.waitFor();
    assert.ok((await entry.innerText()).includes(shown), 'the service measures what the page does');
    assert.equal(await entry.getAttribute('aria-pressed'), 'true');
    await world.picture('measure');
    const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('link', { name: 'GeoJSON' }).click()]);
    const { features } = JSON.parse(await readFile(await download.path(), 'utf8'));
    const feature = features.find(({ properties }) => properties.title === title);
    assert.equal(feature.geometry.type, 'LineString');
    assert.equal(feature.geometry.coordinates.length, 2);
    assert.equal(feature.properties.frame, site.datum ? 'wgs84' : 'site');
    const [csv] = await Promise.all([page.waitForEvent('download'), page.getByRole('link', { name: 'CSV', exact: true }).click()]);
    assert.ok((await readFile(await csv.path(), 'utf8')).includes(title));

    await page.getByRole('button', { name: `Delete ${title}` }).click();
    await page.getByRole('dialog').getByRole('button', { name: 'Keep it' }).click();
    await page.getByRole('button', { name: `Delete ${title}` }).click();
    await page.getByRole('dialog').getByRole('button', { name: 'Delete', exact: true }).click();
    await entry.waitFor({ state: 'detached' });
    const left = await world.json(`/api/v1/sites/${site.name}/measurements?limit=100`);
    assert.ok(left.items.every((item) => item.title !== title));
  },

  async 'a section shows the ground along its line, and is a table'(page, world) {
    await openMeasure(page, world);
    await page.keyboard.press('5');
    await clickGround(page, async () => (await numPoints(page)) === 1);
    await clickGround(page, async () => (await numPoints(page)) === 2, [[0.56, 0.45], [0.55, 0.55], [0.44, 0.5], [0.45, 0.55]]);
    await page.getByRole('button', { name: 'End', exact: true }).click();
    await page.locator('.plot canvas').waitFor();
    await world.picture('section');
    const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Export CSV' }).click()]);
    const rows = (await readFile(await download.path(), 'utf8')).trim().split('\r\n');
    assert.match(rows[0], /^along_m,x_m,y_m,ground_m/);
    assert.ok(rows.length > 10, 'a section has many stations');
    assert.ok(rows.slice(1).some((row) => /^[\d.]+,-?[\d.]+,-?[\d.]+,-?[\d.]+/.test(row)), 'there is ground under it');
  },

  async 'what is half drawn is given up by Escape, and a refused save loses nothing'(page, world) {
    await openMeasure(page, world);
    await page.route('**/measurements', (route) =>
      route.request().method() === 'POST'
        ? route.fulfill({ status: 409, contentType: 'application/problem+json', json: { title: 'Conflict', status: 409, detail: 'the site has 1000 measurements: delete some' } })
        : route.continue(),
    );
    await page.keyboard.press('4');
    await page.keyboard.press('x');
    await page.waitForFunction(() => document.querySelector('.drawing .hint')?.textContent?.startsWith('1'));
    await page.keyboard.press('Enter'); // one point is no slope
    assert.equal(await numPoints(page), 1);
    await page.keyboard.press('Escape');
    await page.locator('.drawing').waitFor({ state: 'detached' });

    await page.keyboard.press('1');
    await page.keyboard.press('x');
    await clickGround(page, async () => (await numPoints(page)) === 2, [[0.56, 0.45], [0.55, 0.55], [0.44, 0.5], [0.45, 0.55]]);
    await page.keyboard.press('Enter');
    await page.getByRole('button', { name: 'Save' }).click();
    await page.getByRole('alert').getByText('delete some').waitFor();
    await page.locator('form .value').waitFor(); // it is not lost
    await page.getByRole('button', { name: 'Discard' }).click();
    await page.locator('form .value').waitFor({ state: 'detached' });
    page.faults = page.faults.filter((fault) => !fault.includes('409')); // the browser's own note of the refusal
  },

  async 'measurements of another version say where they belong'(page, world) {
    const { address, site } = world;
    if (site.versions.length < 2) world.skip('no site has two versions');
    const title = `check of before ${Date.now()}`;
    const before = Math.min(...site.versions);
    const body = JSON.stringify({ kind: 'height', title, version: before, points: [[0, 0, 0], [1, 0, 0.5]] });
    await fetch(`${address}/api/v1/sites/${site.name}/measurements`, { method: 'POST', headers: { 'content-type': 'application/json' }, body });
    try {
      await openMeasure(page, world);
      const entry = page.getByRole('listitem').filter({ hasText: title });
      assert.match(await entry.innerText(), /\+0\.500 m/);
      const href = await entry.getByRole('link').getAttribute('href');
      assert.ok(href.startsWith(`/sites/${site.name}/maps/${before}?tab=measure&chosen=measurement`), href);
      assert.ok(await entry.getByRole('button', { name: new RegExp(`^${title}`) }).isDisabled());
    } finally {
      await removeAll(world, title);
    }
  },
};
