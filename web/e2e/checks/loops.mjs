// Loop review: the list, both pictures, decisions and what is sent of them. No job is started.
import assert from 'node:assert/strict';

import { counted, mapShown } from '../browser.mjs';

/** The latest version that has links between drives, with its report; else the latest one. */
async function reviewed(world) {
  let any = null;
  for (const { name, latest_version: version } of world.sites) {
    if (version === null) continue;
    const report = await world.json(`/api/v1/sites/${encodeURIComponent(name)}/maps/${version}/report.json`);
    any ??= { name, version, report };
    if ((report.join?.pairs ?? []).some(({ links }) => links.length > 0)) return { name, version, report };
  }
  return any;
}

/** Opens the loops of a version as if its first drive had passed two places twice. */
async function openWithLoops(page, world) {
  const site = await reviewed(world);
  if (!site) world.skip('no map');
  const [drive] = site.report.drives;
  const begin = Number(drive.streams.find(({ role }) => role === 'imu').begin);
  const loop = (id, change) => ({
    id, earlier: begin + 2, later: begin + 8, state: 'accepted', num_inliers: 88, num_camera_pairs: 5, score: 0.06, residual: 0.9,
    chi_squared: 4, worst_sigma: 0.03, weight: 1, camera_pairs: [], thumbnails: [], ...change,
  });
  drive.loops.candidates = [loop('1-9', {}), loop('2-8', { num_inliers: 26, num_camera_pairs: 1 }), loop('0-7', { state: 'too few inliers', num_inliers: 5 })];
  await page.route(`**/maps/${site.version}/report.json`, (route) => route.fulfill({ json: site.report }));
  await page.goto(`${world.address}/sites/${site.name}/maps/${site.version}?tab=loops`);
  await mapShown(page, `${site.name}/${site.version}`);
  await page.getByRole('list', { name: 'Loops and links, by doubt' }).waitFor();
  await page.evaluate(() => document.activeElement?.blur());
  return { ...site, drive: drive.name, id: (loop) => `${drive.name}:${loop}` };
}

const queued = (site, change) => ({
  id: '00000000deadbeef', site, drives: [], state: 'queued', stage: null, progress: 0, eta_seconds: null, attempts: 0, engine: null, error: null,
  error_code: null, not_before: null, map_version: null, created_at: '2026-01-01T00:00:00Z', started_at: null, finished_at: null, preview: null, ...change,
});
const build = (page) => page.getByRole('button', { name: 'Build with these decisions' });
const chosen = (page) => page.getByRole('article', { name: 'Chosen pair' });

export const checks = {
  async 'a link shows both pictures, and a spot of the map in both'(page, world) {
    const site = await reviewed(world);
    if (!site || !(site.report.join?.pairs ?? []).some(({ links }) => links.length > 0)) world.skip('no version with links between drives');
    await page.goto(`${world.address}/sites/${site.name}/maps/${site.version}?tab=loops`);
    await mapShown(page, `${site.name}/${site.version}`);
    await page.getByLabel('Kind').selectOption('link');
    await page.getByRole('list', { name: 'Loops and links, by doubt' }).getByRole('button').first().click();
    await page.waitForFunction(() => [...document.querySelectorAll('article figure img')].filter((image) => image.complete && image.naturalWidth > 0).length === 2, null, { timeout: 30_000 });
    assert.ok(new URL(page.url()).searchParams.get('loop').includes('~'));
    for (const side of ['Ahead', 'Left', 'Right', 'Behind']) {
      await chosen(page).getByRole('button', { name: side, exact: true }).click();
      await page.waitForFunction(() => !document.querySelector('article fieldset').disabled);
      if ((await page.locator('article figure svg').count()) === 2) break;
    }
    await page.waitForFunction(() => document.querySelectorAll('article figure svg').length === 2);
    await world.picture('loops_spot');
  },

  async 'inliers are drawn in both pictures, and one that is pointed at is found in the other'(page, world) {
    const site = await reviewed(world);
    const drive = site?.report.drives.find(({ loops }) => loops.candidates.some(({ inliers }) => inliers?.points.length > 0));
    if (!drive) world.skip('no loop with inliers');
    const { id, inliers } = drive.loops.candidates.find((loop) => loop.inliers?.points.length > 0);
    await page.goto(`${world.address}/sites/${site.name}/maps/${site.version}?tab=loops&loop=${drive.name}:${id}`);
    await mapShown(page, `${site.name}/${site.version}`);
    await page.locator('svg.inliers').nth(1).waitFor();
    for (const end of [0, 1]) await counted(page.locator('svg.inliers').nth(end).locator('circle'), inliers.points.length);
    const times = await page.locator('article figure img').evaluateAll((images) => images.map((image) => image.dataset.time));
    assert.deepEqual(times, inliers.times, 'the very images that were matched');
    await page.locator('svg.inliers').first().locator('circle').last().hover({ force: true });
    await page.locator('svg.inliers').nth(1).locator('circle.pointed').waitFor();
    await page.getByLabel('Camera of picture A').selectOption({ index: (await page.getByLabel('Camera of picture A').locator('option').allInnerTexts()).findIndex((camera) => camera !== inliers.cameras[0]) });
    await page.locator('svg.inliers').first().waitFor({ state: 'detached' });
    await page.getByRole('button', { name: 'Show the inliers' }).click();
    await page.locator('svg.inliers').first().waitFor();
  },

  async 'keys step and decide; only what changes the map is sent, and the job is followed'(page, world) {
    const { name, version, id } = await openWithLoops(page, world);
    await page.keyboard.press('j');
    await chosen(page).getByRole('heading', { name: '2 ↔ 8' }).waitFor(); // the least evidence first
    await page.keyboard.press('x');
    await page.getByLabel('Kind').selectOption('loop');
    await page.getByLabel('State').selectOption('rejected');
    await page.evaluate(() => document.activeElement?.blur());
    await page.keyboard.press('j');
    await chosen(page).getByRole('heading', { name: '0 ↔ 7' }).waitFor();
    await page.keyboard.press('y');
    await page.getByLabel('State').selectOption('accepted');
    await page.getByLabel('Your decision', { exact: true }).selectOption('undecided');
    const rows = page.getByRole('list', { name: 'Loops and links, by doubt' }).getByRole('button');
    await counted(rows, 1);
    await rows.first().click();
    await chosen(page).getByRole('button', { name: /^Accept/ }).click(); // agrees with the mapper
    await page.reload();
    await mapShown(page, `${name}/${version}`);
    const decisions = page.getByRole('region', { name: 'Your decisions' });
    await counted(decisions.getByRole('listitem'), 3, 'a draft outlives a reload');

    let sent = null;
    let job = queued(name, {});
    await page.route('**/api/v1/jobs/00000000deadbeef', (route) => route.fulfill({ json: job }));
    await page.route(`**/api/v1/sites/${name}/maps`, async (route) => {
      if (route.request().method() !== 'POST') return route.fallback();
      sent = route.request().postDataJSON();
      return route.fulfill({ status: 202, json: job });
    });
    await build(page).click();
    const progress = page.getByRole('region', { name: 'The version that is being built' });
    await progress.getByText('It waits for its turn').waitFor();
    assert.deepEqual(sent, { from: version, reject_loops: [id('2-8')], force_loops: [id('0-7')], reject_links: [], force_links: [] });
    job = queued(name, { state: 'done', progress: 1, map_version: version + 1 });
    const link = progress.getByRole('link', { name: 'What changed after' });
    await link.waitFor({ timeout: 15_000 });
    assert.equal(await link.getAttribute('href'), `/sites/${name}/compare?from=${version}&to=${version + 1}`);
    await progress.getByRole('button', { name: 'Put away' }).click();
    await decisions.getByRole('button', { name: 'Clear all' }).click();
    assert.equal(await page.evaluate((key) => localStorage.getItem(key), `parkade.loops.${name}.${version}`), null);
  },

  async 'a link between drives is left out as a loop is'(page, world) {
    const site = await reviewed(world);
    const pair = (site?.report.join?.pairs ?? []).find(({ links }) => links.some(({ weight }) => weight > 0.5));
    if (!pair) world.skip('no version with links between drives');
    const link = pair.links.find(({ weight }) => weight > 0.5);
    const id = `${pair.a}:${link.place_a}~${pair.b}:${link.place_b}`;
    let sent = null;
    await page.route(`**/api/v1/sites/${site.name}/maps`, async (route) => {
      if (route.request().method() !== 'POST') return route.fallback();
      sent = route.request().postDataJSON();
      return route.fulfill({ status: 202, json: queued(site.name, {}) });
    });
    await page.route('**/api/v1/jobs/00000000deadbeef', (route) => route.fulfill({ json: queued(site.name, {}) }));
    await page.goto(`${world.address}/sites/${site.name}/maps/${site.version}?tab=loops&loop=${encodeURIComponent(id)}`);
    await mapShown(page, `${site.name}/${site.version}`);
    await chosen(page).getByRole('heading', { name: `${pair.a} ${link.place_a} ↔ ${pair.b} ${link.place_b}` }).waitFor();
    await chosen(page).getByRole('button', { name: /^Accept/ }).click(); // agrees with the mapper
    assert.ok(await build(page).isDisabled());
    await chosen(page).getByRole('button', { name: /^Reject/ }).click();
    await chosen(page).getByText('In the next version this link is left out.').waitFor();
    await build(page).click();
    await page.getByRole('region', { name: 'The version that is being built' }).waitFor();
    assert.deepEqual(sent, { from: site.version, reject_loops: [], force_loops: [], reject_links: [id], force_links: [] });
    await page.evaluate((key) => localStorage.removeItem(key), `parkade.loops.${site.name}.${site.version}`);
  },

  async 'a refused build says why and keeps the decisions'(page, world) {
    const { name } = await openWithLoops(page, world);
    await page.keyboard.press('j');
    await page.keyboard.press('x');
    await page.route(`**/api/v1/sites/${name}/maps`, (route) =>
      route.request().method() === 'POST'
        ? route.fulfill({ status: 409, contentType: 'application/problem+json', json: { type: 'about:blank', title: 'Conflict', status: 409, code: 'conflict', detail: 'the log of the drive was deleted' } })
        : route.fallback(),
    );
    await build(page).click();
    await page.getByRole('alert').filter({ hasText: 'the log of the drive was deleted' }).waitFor();
    const undo = page.getByRole('region', { name: 'Your decisions' }).getByRole('button', { name: /^Undo/ });
    await counted(undo, 1);
    await undo.click();
    await build(page).waitFor({ state: 'detached' });
    page.faults.length = 0; // the refusal is told on the console
  },

  async 'a pair is forced by its numbers or by two clicks, and places that are none are refused'(page, world) {
    const { drive } = await openWithLoops(page, world);
    await page.getByText('Force a pair that was not found').click();
    const form = page.getByRole('form', { name: 'A pair to force' });
    for (const which of ['First', 'Second']) await form.getByLabel(`${which} drive`).selectOption(drive);
    const place = form.getByRole('spinbutton', { name: 'First place' });
    const other = form.getByRole('spinbutton', { name: 'Second place' });
    await place.fill('3');
    await other.fill('3');
    await form.getByRole('button', { name: 'Look at it' }).click();
    await form.getByRole('alert').filter({ hasText: 'two different places' }).waitFor();
    await place.fill('9');
    await form.getByRole('button', { name: 'Look at it' }).click();
    await chosen(page).getByRole('heading', { name: '3 ↔ 9' }).waitFor();
    await chosen(page).getByRole('button', { name: 'Force this pair' }).click();
    const decisions = page.getByRole('region', { name: 'Your decisions' });
    await decisions.getByText('is forced').waitFor();
    await decisions.getByRole('button', { name: /^Undo/ }).click();

    await form.getByRole('button', { name: 'Click two places in the map' }).click();
    const { width, height } = await page.locator('#canvas').boundingBox();
    await page.locator('#canvas').click({ position: { x: width * 0.5, y: height * 0.5 } });
    await form.getByText('Now the second.').waitFor();
    await page.locator('#canvas').click({ position: { x: width * 0.5, y: height * 0.45 } });
    await form.getByRole('button', { name: 'Click two places in the map' }).waitFor();
    await chosen(page).getByText('not in the report').or(chosen(page).getByRole('button', { name: /^Accept/ })).first().waitFor();
  },

  async 'a pair of places of two drives is forced as a link'(page, world) {
    const site = await reviewed(world);
    const pair = (site?.report.join?.pairs ?? [])[0];
    if (!pair) world.skip('no version of two drives');
    const isKnown = (a, b) => pair.links.some(({ place_a, place_b }) => place_a === a && place_b === b);
    const [a, b] = [0, 1, 2, 3, 4].flatMap((a) => [0, 1, 2, 3, 4].map((b) => [a, b])).find(([a, b]) => !isKnown(a, b));
    let sent = null;
    await page.route(`**/api/v1/sites/${site.name}/maps`, async (route) => {
      if (route.request().method() !== 'POST') return route.fallback();
      sent = route.request().postDataJSON();
      return route.fulfill({ status: 202, json: queued(site.name, {}) });
    });
    await page.route('**/api/v1/jobs/00000000deadbeef', (route) => route.fulfill({ json: queued(site.name, {}) }));
    await page.goto(`${world.address}/sites/${site.name}/maps/${site.version}?tab=loops`);
    await mapShown(page, `${site.name}/${site.version}`);
    await page.getByText('Force a pair that was not found').click();
    const form = page.getByRole('form', { name: 'A pair to force' });
    await form.getByLabel('First drive').selectOption(pair.b); // named in the report's order all the same
    await form.getByLabel('Second drive').selectOption(pair.a);
    await form.getByRole('spinbutton', { name: 'First place' }).fill(String(b));
    await form.getByRole('spinbutton', { name: 'Second place' }).fill(String(a));
    await form.getByRole('button', { name: 'Look at it' }).click();
    await chosen(page).getByRole('heading', { name: `${pair.a} ${a} ↔ ${pair.b} ${b}` }).waitFor();
    await chosen(page).getByRole('button', { name: 'Force this pair' }).click();
    await build(page).click();
    await page.getByRole('region', { name: 'The version that is being built' }).waitFor();
    assert.deepEqual(sent, { from: site.version, reject_loops: [], force_loops: [], reject_links: [], force_links: [`${pair.a}:${a}~${pair.b}:${b}`] });
    await page.evaluate((key) => localStorage.removeItem(key), `parkade.loops.${site.name}.${site.version}`);
  },
};
