// Layers of a map: what is shown, in which colors, at which height, and what the page says of the version.
import assert from 'node:assert/strict';

import { mapShown } from '../browser.mjs';

async function openMap(page, { address, site }, query = '') {
  await page.goto(`${address}/sites/${site.name}/maps/${site.latest_version}${query}`);
  await mapShown(page, `${site.name}/${site.latest_version}`);
}

const query = (page) => new URL(page.url()).searchParams;
const waitForQuery = (page, name, value) =>
  page.waitForFunction(([key, wanted]) => new URLSearchParams(location.search).get(key) === wanted, [name, value]);
const row = (page, name) => page.locator(`[data-layer="${name}"]`);
const box = (page, name) => row(page, name).locator('input');
const ready = (page, name) => page.locator(`[data-layer="${name}"][data-stage="ready"]`).waitFor();
const legend = (page) => page.locator('aside[aria-label="Legend"]');

/** A refused file is an error on the console, which is what the check is about. */
const forgive = (page) => page.faults.splice(0);

/** A map that has several levels; skips where there is none. */
async function garageOf(world) {
  for (const site of world.sites.filter(({ latest_version }) => latest_version)) {
    const { features } = await world.json(`/api/v1/sites/${site.name}/maps/${site.latest_version}/free_space.geojson`);
    const levels = new Set(features.map(({ properties }) => properties.level));
    if (levels.size > 1) return { site, levels: [...levels].sort() };
  }
  return world.skip('no map has two levels');
}

/** Counts calls that draw, by frame; for a page that has not loaded yet. */
const countDraws = (page) =>
  page.addInitScript(() => {
    window.draws = { now: 0, most: 0 };
    const proto = WebGL2RenderingContext.prototype;
    for (const name of ['drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced']) {
      const draw = proto[name];
      proto[name] = function (...rest) {
        window.draws.now += 1;
        return draw.apply(this, rest);
      };
    }
    const request = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (run) =>
      request((time) => {
        window.draws.now = 0;
        run(time);
        window.draws.most = Math.max(window.draws.most, window.draws.now);
      });
  });

/** The latest version of which gnss.json tells where fixes lie, with those of a drive. */
async function fixesOf(world) {
  for (const site of world.sites.filter(({ latest_version }) => latest_version)) {
    const { files } = await world.json(`/api/v1/sites/${site.name}/maps/${site.latest_version}`);
    const file = files.find(({ name }) => name.endsWith('/gnss.json'));
    if (file) return { site, ...(await world.json(file.url)) };
  }
  return world.skip('no version says where its GNSS fixes lie');
}

export const checks = {
  async 'GNSS fixes lie where they were measured, and say how far they are off'(page, world) {
    const { site, fixes } = await fixesOf(world);
    const fix = fixes.find(({ state }) => state === 'used') ?? fixes[0];
    const [x, y, z] = fix.position;
    const view = [x, y - 0.1, z + 14, x, y, z].map((value) => value.toFixed(3)).join(',');
    await openMap(page, { ...world, site }, `?layers=gnss&view=${view}`);
    await ready(page, 'gnss');
    await legend(page).getByText('GNSS fixes').waitFor();
    await legend(page).getByText(/^used, \d+$/).waitFor();
    const { x: left, y: top, width, height } = await page.locator('#canvas').boundingBox();
    await page.mouse.move(left + width / 2 - 60, top + height / 2 - 60);
    await page.mouse.move(left + width / 2, top + height / 2);
    const note = page.getByRole('status', { name: 'GNSS fix' });
    await note.getByText(/^\d+\.\d\d m off the way/).waitFor();
    await world.picture('gnss');
    await page.mouse.move(left + 5, top + height - 5);
    await note.waitFor({ state: 'detached' });
    await box(page, 'gnss').uncheck();
    await page.mouse.move(left + width / 2, top + height / 2);
    assert.equal(await note.count(), 0, 'what is hidden says nothing');
  },

  async 'what is shown is in the address and survives a reload'(page, world) {
    await openMap(page, world);
    await ready(page, 'free');
    assert.equal(query(page).get('layers'), null, 'the usual layers need no words');
    await box(page, 'free').uncheck();
    await box(page, 'gnss').check();
    await waitForQuery(page, 'layers', '-free,gnss');
    await ready(page, 'gnss');
    await page.reload();
    await mapShown(page, `${world.site.name}/${world.site.latest_version}`);
    assert.equal(await box(page, 'free').isChecked(), false);
    assert.equal(await box(page, 'gnss').isChecked(), true);
    await box(page, 'free').check();
    await box(page, 'gnss').uncheck();
    await waitForQuery(page, 'layers', null);
  },

  async 'a layer that cannot be loaded says so, and can be asked for again'(page, world) {
    await page.route('**/markings.geojson', (route) =>
      route.fulfill({ status: 500, contentType: 'application/problem+json', body: '{"detail":"the stored file is damaged"}' }),
    );
    const report = await world.json(`/api/v1/sites/${world.site.name}/maps/${world.site.latest_version}/report.json`);
    if (!report.map.num_markings) world.skip('this map has no markings');
    await openMap(page, world);
    await box(page, 'markings').check();
    const alert = page.locator('li').filter({ has: row(page, 'markings') }).getByRole('alert');
    await alert.getByText('the stored file is damaged').waitFor();
    forgive(page);
    await page.unroute('**/markings.geojson');
    await alert.getByRole('button', { name: 'Try again' }).click();
    await ready(page, 'markings');
    assert.equal(await alert.count(), 0);
  },

  async 'the ground takes each color, and a legend says what it means'(page, world) {
    await openMap(page, world);
    const color = page.getByLabel('Color of the ground');
    for (const [name, text] of [['height', /-?[\d.]+ m/], ['slope', '16 %'], ['sigma', 'mm'], ['session', 'within 12 m'], ['age', /[\d.]+ d/]]) {
      await color.selectOption(name);
      await waitForQuery(page, 'color', name);
      await legend(page).getByText(text).first().waitFor();
    }
    await world.picture('layers_age');
    await page.reload();
    await mapShown(page, `${world.site.name}/${world.site.latest_version}`);
    assert.equal(await color.inputValue(), 'age');
    await color.selectOption('picture');
    await waitForQuery(page, 'color', null);
  },

  async 'a color that cannot be had is refused in words'(page, world) {
    await page.route('**/ground.ply', (route) => route.fulfill({ status: 500, body: '' }));
    await openMap(page, world);
    await page.getByLabel('Color of the ground').selectOption('sigma');
    await page.getByRole('alert').filter({ hasText: 'Not colored' }).waitFor();
    forgive(page);
  },

  async 'trajectories take the color of a number, or say why not'(page, world) {
    await openMap(page, world);
    const color = page.getByLabel('Color of trajectories');
    await page.route('**/plots*', (route) =>
      route.fulfill({ status: 503, contentType: 'application/problem+json', body: '{"detail":"too many ask at once"}' }),
    );
    await color.selectOption('speed');
    const alert = page.getByRole('alert').filter({ hasText: 'too many ask at once' });
    await alert.waitFor();
    forgive(page);
    await page.unroute('**/plots*');
    await alert.getByRole('button', { name: 'Try again' }).click();
    await legend(page).getByText('m/s').first().waitFor();
    for (const [name, unit] of [['residual', 'mrad'], ['sigma', 'm'], ['gnss', 'm']]) {
      await color.selectOption(name);
      await waitForQuery(page, 'path', name);
      await legend(page).getByText(new RegExp(`[\\d.]+ ${unit}$`)).first().waitFor();
    }
  },

  async 'a slot is chosen from the list and by a click, and Escape lets it go'(page, world) {
    const { features } = await world.json(`/api/v1/sites/${world.site.name}/maps/${world.site.latest_version}/slots.geojson`);
    if (features.length === 0) world.skip('this map has no slots');
    const { id, type } = features[0].properties;
    await openMap(page, world);
    await ready(page, 'slots');
    await page.getByText('List of slots').click();
    await page.locator('.slots button', { hasText: id }).click();
    const card = page.getByRole('region', { name: `Slot ${id}` });
    await card.getByText(type).waitFor();
    await world.picture('layers_slot');
    await page.keyboard.press('Escape');
    await card.waitFor({ state: 'detached' });
    const { width, height } = await page.locator('#canvas').boundingBox();
    await page.locator('#canvas').click({ position: { x: width / 2, y: height / 2 } }); // the list turned the camera to it
    await card.waitFor();
    await card.getByRole('button', { name: 'Next slot' }).click();
    await card.waitFor({ state: 'detached' });
    await page.getByRole('button', { name: 'Close', exact: true }).click();
    assert.equal(await page.getByRole('region', { name: /^Slot/ }).count(), 0);
  },

  async 'a deck of a garage is shown alone, and its address shows it again'(page, world) {
    const { site, levels } = await garageOf(world);
    await openMap(page, { ...world, site }, '?color=height');
    const level = page.getByRole('group', { name: 'Level' }).getByRole('button', { name: String(levels.at(-1)), exact: true });
    await level.click();
    await waitForQuery(page, 'level', String(levels.at(-1)));
    await legend(page).getByText(`of level ${levels.at(-1)}`).waitFor();
    await world.picture('layers_deck');
    await page.reload();
    await mapShown(page, `${site.name}/${site.latest_version}`);
    await level.and(page.locator('[aria-pressed="true"]')).waitFor();
    await page.getByRole('group', { name: 'Level' }).getByRole('button', { name: 'All' }).click();
    await waitForQuery(page, 'level', null);
  },

  async 'a height slice is set by keys and undone'(page, world) {
    await openMap(page, world);
    await page.getByText('Height slice').click();
    const low = page.getByLabel('From', { exact: true });
    await low.focus();
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction(() => /^-?[\d.]+,-?[\d.]+$/.test(new URLSearchParams(location.search).get('slice') ?? ''));
    await page.getByRole('button', { name: 'All heights' }).click();
    await waitForQuery(page, 'slice', null);
  },

  async 'all layers at once are few draw calls'(page, world) {
    await countDraws(page);
    await openMap(page, world);
    await page.evaluate(() => {
      for (const input of [...document.querySelectorAll('[data-layer] input:not(:disabled):not(:checked)')]) input.click();
    });
    await page.waitForFunction(() => [...document.querySelectorAll('[data-layer]:has(input:checked)')].every(({ dataset }) => dataset.layer === 'ground' || dataset.stage === 'ready'));
    await page.getByRole('button', { name: 'Overview' }).click();
    await page.evaluate(() => (window.draws.most = 0));
    await page.locator('#canvas').focus();
    await page.keyboard.press('Shift+ArrowLeft'); // turns the map
    await page.waitForFunction(() => window.draws.most > 0);
    const most = await page.evaluate(() => window.draws.most);
    await world.picture('layers_all');
    console.log(`      ${most} draw calls in a frame with all layers`);
    assert.ok(most <= 60, `${most} draw calls`);
  },

  async 'the info panel says what the version is made of'(page, world) {
    await openMap(page, world);
    const map = await world.json(`/api/v1/sites/${world.site.name}/maps/${world.site.latest_version}`);
    const panel = page.locator('#details');
    for (const { id, name } of map.drives) await panel.locator(`a[href="/drives/${id}"]`, { hasText: name }).waitFor();
    await panel.getByText('m²').first().waitFor();
    await panel.getByText('Place on Earth').waitFor();
    await panel.getByText(/How it was made/).click();
    await panel.locator('table tr').nth(3).waitFor(); // stages of the job
  },
};
