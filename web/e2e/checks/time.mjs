// A drive over time: plots, the car, the pictures at a time, and those that show a spot.
import assert from 'node:assert/strict';

import { counted, mapShown } from '../browser.mjs';

/** A drive of the site's latest map that has plots, its keyframes, and its map's path. */
async function find(world) {
  const { site } = world;
  const map = `/sites/${site.name}/maps/${site.latest_version}`;
  for (const { id, name } of (await world.json(`/api/v1${map}`)).drives) {
    const query = `version=${site.latest_version}&points=500`;
    const plots = await world.json(`/api/v1/drives/${id}/plots?${query}`).catch(() => null);
    const keyframes = plots && (await world.json(`/api/v1/drives/${id}/keyframes?${query}`).catch(() => null));
    const { log } = await world.json(`/api/v1/drives/${id}`);
    if (keyframes?.keyframes.length > 0 && log === 'stored')
      return { id, name, plots, keyframes, map, shown: `${site.name}/${site.latest_version}` };
  }
  return world.skip('no drive of the latest map has plots, keyframes and a log');
}

const seconds = (start, stamp) => Number(BigInt(stamp.replace('.', '')) - BigInt(start.replace('.', ''))) / 1e9;
const slider = (page) => page.getByRole('slider', { name: 'Time of the drive' });

async function open(page, world, drive, query = '') {
  await page.goto(`${world.address}${drive.map}?tab=time&drive=${drive.id}${query}`);
  await page.locator('.plot canvas').nth(1).waitFor();
}

/** Answers that are refused on purpose are no faults of the page. */
function forgive(page, status) {
  const others = page.faults.filter((fault) => !fault.includes(`status of ${status}`));
  page.faults.splice(0, page.faults.length, ...others);
}

export const checks = {
  async 'plots and pictures follow the time, which the address keeps'(page, world) {
    const drive = await find(world);
    const middle = drive.plots.end / 2;
    await open(page, world, drive, `&t=${middle.toFixed(2)}`);
    const cameras = drive.keyframes.cameras.length;
    await page.waitForFunction((count) => document.querySelectorAll('.tile img').length === count, cameras);
    await page.locator('.plot canvas').nth(2).waitFor();
    for (const { name } of drive.keyframes.cameras) await page.getByRole('button', { name }).first().waitFor();
    await counted(page.locator('.tile small'), cameras, 'each picture says how far off it was taken');
    assert.equal(Number(await slider(page).inputValue()), Number(middle.toFixed(2)));

    const before = await page.locator('.tile img').first().getAttribute('src');
    await slider(page).focus();
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction((t) => Number(new URLSearchParams(location.search).get('t')) > t, Number(middle.toFixed(2)));
    const at = Number(new URL(page.url()).searchParams.get('t'));
    const { start } = drive.plots;
    assert.ok(at - middle < 5 && drive.keyframes.keyframes.some(({ time }) => seconds(start, time) > middle), 'a step leads to a keyframe');
    await page.waitForFunction((src) => document.querySelector('.tile img')?.src !== src, before);
    await page.reload();
    await page.locator('.plot canvas').nth(1).waitFor();
    await page.waitForFunction((t) => Number(document.querySelector('input[aria-label="Time of the drive"]')?.value) === t, at);
  },

  async 'Home and End lead to the ends of a drive, also while its plots are on their way'(page, world) {
    const drive = await find(world);
    let send = () => undefined;
    const isWanted = new Promise((resolve) => (send = resolve));
    await page.route('**/plots?*', async (route) => {
      await isWanted;
      await route.continue();
    });
    await page.goto(`${world.address}${drive.map}?tab=time&drive=${drive.id}`);
    const shows = (expected) => page.waitForFunction((at) => Math.abs(Number(document.querySelector('input[aria-label="Time of the drive"]')?.value) - at) < 1, expected);
    await slider(page).focus();
    await page.keyboard.press('End');
    await shows(drive.plots.end);
    await page.keyboard.press('Home');
    await shows(0);
    send();
    await page.locator('.plot canvas').nth(1).waitFor();
    await page.keyboard.press('End');
    await shows(drive.plots.end);
    await page.keyboard.press('z'); // a slider leaves alone what it does not mean
    await page.locator('.scrubber rect.window').waitFor({ state: 'attached' });
    await page.getByRole('button', { name: 'Follow' }).focus();
    await page.keyboard.press('Home');
    await shows(0);
  },

  async 'a stretch of time is brushed out of the plots, and given back'(page, world) {
    const drive = await find(world);
    await open(page, world, drive);
    await mapShown(page, drive.shown); // a page that is still busy loses a quick drag
    const whole = page.getByRole('button', { name: 'Whole drive' });
    assert.ok(await whole.isDisabled());
    const plot = page.locator('.plot .u-over').nth(1);
    const box = await plot.boundingBox();
    await page.mouse.move(box.x + 0.3 * box.width, box.y + 20);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.5 * box.width, box.y + 20, { steps: 4 });
    await page.mouse.up();
    await page.locator('.scrubber rect.window').waitFor({ state: 'attached' });
    const width = Number(await page.locator('.scrubber rect.window').getAttribute('width'));
    assert.ok(Math.abs(width - 0.2 * drive.plots.end) < 0.05 * drive.plots.end, `${width} s of ${drive.plots.end}`);
    await whole.click();
    await page.locator('.scrubber rect.window').waitFor({ state: 'detached' });
    await page.getByRole('button', { name: 'Plots' }).click();
    const count = await page.locator('.plot canvas').count();
    await page.getByRole('checkbox', { name: 'Speed' }).uncheck();
    await page.waitForFunction((expected) => document.querySelectorAll('.plot canvas').length === expected, count - 1);
    await page.getByRole('checkbox', { name: 'Speed' }).check();
  },

  async 'a brushed stretch is asked for by itself, and shown in full'(page, world) {
    const drive = await find(world);
    const asked = [];
    await page.route('**/plots?*', async (route) => {
      const query = new URL(route.request().url()).searchParams;
      const response = await route.fetch();
      const json = await response.json();
      if (query.has('from')) {
        asked.push(query);
        for (const series of json.series) if (series.name === 'speed') series.values = series.values.map(() => 7.77);
      } else for (const series of json.series) series.count = series.times.length + 1; // as if the service had left some out
      return route.fulfill({ response, json });
    });
    await open(page, world, drive);
    await mapShown(page, drive.shown);
    const plot = page.locator('.plot .u-over').nth(1);
    const box = await plot.boundingBox();
    await page.mouse.move(box.x + 0.4 * box.width, box.y + 20);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.5 * box.width, box.y + 20, { steps: 4 });
    const answered = page.waitForResponse((response) => new URL(response.url()).searchParams.has('from'));
    await page.mouse.up();
    await answered;
    const shown = page.locator('.row-of').filter({ hasText: 'Speed' }).getByText('7.77');
    for (let i = 0; i < 50 && !(await shown.isVisible()); ++i) {
      await page.mouse.move(box.x + (0.5 + 0.002 * i) * box.width, box.y + 22); // its value is read where the pointer is
      await page.waitForTimeout(100);
    }
    assert.ok(await shown.isVisible(), 'what was asked for is drawn');
    const [from, to] = ['from', 'to'].map((name) => (Number(asked[0].get(name)) - Number(drive.plots.start)) / drive.plots.end);
    assert.ok(Math.abs(from - 0.3) < 0.04 && Math.abs(to - 0.6) < 0.04, `${from} to ${to} of the drive`);
  },

  async 'it plays, and does not write the address with every frame'(page, world) {
    const drive = await find(world);
    await page.addInitScript(() => {
      window.written = 0;
      const { replaceState } = history;
      history.replaceState = (...all) => ((window.written += 1), replaceState.apply(history, all));
    });
    await open(page, world, drive, '&t=1.00');
    await mapShown(page, drive.shown);
    await page.locator('#details').focus();
    await page.evaluate(() => (window.written = 0));
    const started = Date.now();
    await page.keyboard.press(' ');
    await page.getByRole('button', { name: 'Pause' }).waitFor();
    await page.waitForFunction(() => Number(new URLSearchParams(location.search).get('t')) > 1.5);
    await page.keyboard.press(' ');
    await page.getByRole('button', { name: 'Play' }).waitFor();
    const most = 4 + (Date.now() - started) / 300; // the view's address is written, too
    assert.ok((await page.evaluate(() => window.written)) < most);
  },

  async 'a click on the ground leads to the pictures that show the spot'(page, world) {
    const drive = await find(world);
    const { keyframes } = drive.keyframes;
    const [x, y, z] = keyframes[Math.floor(0.6 * keyframes.length)].site_from_body.position;
    await open(page, world, drive, `&t=0.50&view=${[x, y - 0.1, z + 14, x, y, z].map((value) => value.toFixed(2)).join(',')}`);
    await mapShown(page, drive.shown);
    const canvas = page.locator('#canvas');
    const { width, height } = await canvas.boundingBox();
    await canvas.click({ position: { x: width / 2, y: height / 2 } });
    await page.locator('.thumb svg circle').first().waitFor({ timeout: 60_000 });
    await page.locator('.thumb').first().click();
    const dialog = page.getByRole('dialog');
    await dialog.locator('svg circle').first().waitFor();
    await page.waitForFunction(() => new URLSearchParams(location.search).get('t') !== '0.50');
    const count = await page.locator('.thumb').count();
    if (count > 1) {
      await page.keyboard.press('ArrowRight');
      await dialog.getByText(`picture 2 of ${count}`).waitFor();
    }
    await page.keyboard.press('Escape');
    await dialog.waitFor({ state: 'detached' });
    await counted(page.locator('.thumb'), count, 'the spot stays chosen');
    await page.keyboard.press('Escape');
    await page.getByText('No spot is chosen').waitFor();
  },

  async 'a map of an older program has pictures, and says why it has no plots'(page, world) {
    const drive = await find(world);
    await page.route(/\/api\/v1\/drives\/[^/]+\/(plots|keyframes)\?/, (route) =>
      route.fulfill({ status: 409, contentType: 'application/problem+json', body: JSON.stringify({ detail: 'this map is old: build it anew' }) }),
    );
    await page.goto(`${world.address}${drive.map}?tab=time&drive=${drive.id}&t=1.00`);
    await page.getByText('There is nothing to plot of this drive').waitFor();
    await page.getByText('This map is old: build it anew').waitFor();
    await page.locator('.tile img').first().waitFor();
    forgive(page, 409);
  },

  async 'without the log, or without the right, no picture is asked for'(page, world) {
    const drive = await find(world);
    let asked = 0;
    await page.route(/\/api\/v1\/drives\/[^/]+\/images/, (route) => ((asked += 1), route.continue()));
    await page.route(`**/api/v1/drives/${drive.id}`, async (route) => {
      const answer = await route.fetch();
      await route.fulfill({ response: answer, json: { ...(await answer.json()), log: 'deleted', log_deleted_at: '2026-01-01T00:00:00.000Z' } });
    });
    await open(page, world, drive);
    await page.getByText('The log of this drive was deleted').waitFor();
    await page.route('**/api/v1/session', async (route) => {
      const answer = await route.fetch();
      const session = await answer.json();
      await route.fulfill({ response: answer, json: { ...session, caller: { ...session.caller, pictures: false } } });
    });
    await page.reload();
    await page.getByText('You may not see camera pictures').waitFor();
    assert.equal(asked, 0);
  },

  async 'a moment without a picture says so'(page, world) {
    const drive = await find(world);
    await page.route(/\/api\/v1\/drives\/[^/]+\/images\//, (route) =>
      route.fulfill({ status: 404, contentType: 'application/problem+json', body: JSON.stringify({ detail: 'no image within a second' }) }),
    );
    await open(page, world, drive);
    await page.getByText('No image within a second').first().waitFor();
    assert.equal(await page.locator('.tile img').count(), 0);
    forgive(page, 404);
  },
};
