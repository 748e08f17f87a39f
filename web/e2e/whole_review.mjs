// One review as a person would do it, with the page alone: node e2e/whole_review.mjs ADDRESS SITE [--pictures FOLDER]
// Opens what awaits, looks at time, loops and changes, measures, comments, rejects; builds a version without a loop,
// sees what changed, and approves it. SITE needs a draft with loops, and a version before it. It leaves a version.
import assert from 'node:assert/strict';
import path from 'node:path';
import { parseArgs } from 'node:util';

import { mapShown, openBrowser, openPage } from './browser.mjs';
import { clickGround, viewOfGround } from './ground.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: { pictures: { type: 'string' } } });
const [address, name] = positionals;
if (!name) throw new Error('usage: node e2e/whole_review.mjs ADDRESS SITE [--pictures FOLDER]');
const json = async (route) => (await fetch(`${address}/api/v1${route}`)).json();
const site = await json(`/sites/${name}`);
const before = site.latest_version;

const { context, close } = await openBrowser();
const page = await openPage(context, `${address}/review`);
const picture = (as) => (values.pictures ? page.screenshot({ path: path.join(values.pictures, `review_${as}.png`) }) : null);
const tab = (title) => page.getByRole('tab', { name: title }).click();
const dialog = page.getByRole('dialog');
const step = (what) => console.log(`${((Date.now() - started) / 1000).toFixed(0).padStart(4)} s  ${what}`);
const started = Date.now();

async function decide(button, reason) {
  await tab('Review');
  await page.getByRole('button', { name: button, exact: true }).click();
  if (reason) await dialog.getByRole('textbox').fill(reason);
  await dialog.getByRole('button', { name: button, exact: true }).click();
  await dialog.waitFor({ state: 'detached' });
}

try {
  await page.locator(`a[href*="/sites/${name}/maps/${before}"]`).first().click();
  await mapShown(page, `${name}/${before}`);
  step('opened what awaits');
  await tab('Review');
  await page.getByRole('region', { name: 'Comments' }).waitFor();
  if (await page.getByRole('button', { name: 'Submit', exact: true }).isVisible()) await decide('Submit'); // else somebody did
  await page.getByText('in review', { exact: true }).first().waitFor();
  step('submitted');

  await tab('Time');
  await page.locator('.plot canvas').nth(1).waitFor();
  await page.getByRole('slider', { name: 'Time of the drive' }).press('ArrowRight');
  await page.waitForFunction(() => [...document.querySelectorAll('.tile img')].filter((image) => image.complete && image.naturalWidth > 0).length >= 4);
  step('saw plots and pictures');

  await tab('Loops');
  await page.getByLabel('Kind').selectOption('loop');
  await page.getByLabel('State').selectOption('accepted');
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press('j');
  await page.locator('svg.inliers circle').first().waitFor();
  assert.equal(await page.locator('svg.inliers').count(), 2, 'inliers in both pictures');
  assert.equal(await page.locator('svg.inliers').first().locator('circle').count(), await page.locator('svg.inliers').last().locator('circle').count());
  await picture('loop');
  const rejected = new URL(page.url()).searchParams.get('loop');
  await page.keyboard.press('x');
  await page.keyboard.press('j');
  await page.keyboard.press('y');
  step(`looked at loops, rejects ${rejected}`);

  await page.getByRole('link', { name: 'Compare' }).first().click();
  await page.getByRole('heading', { name: /\d+ changes?/ }).waitFor({ timeout: 120_000 });
  const count = Number(/^\d+/.exec(await page.getByRole('heading', { name: /\d+ changes?/ }).innerText())[0]);
  for (let i = 0; i < Math.min(count, 3); ++i) {
    await page.keyboard.press('j');
    await page.waitForFunction(() => new URLSearchParams(location.search).has('change'));
  }
  await picture('changes');
  step(`stepped through ${Math.min(count, 3)} of ${count} changes`);

  const view = await viewOfGround({ address, site });
  await page.goto(`${address}/sites/${name}/maps/${before}?tab=measure&view=${view}`);
  await mapShown(page, `${name}/${before}`);
  await page.getByRole('button', { name: 'Distance', exact: true }).click();
  const points = async () => Number(/^\d+/.exec(await page.locator('.drawing .hint').first().innerText())?.[0] ?? 0);
  await clickGround(page, async () => (await points()) === 1);
  await clickGround(page, async () => (await points()) === 2, [[0.56, 0.45], [0.55, 0.55], [0.44, 0.5], [0.45, 0.55]]);
  await page.keyboard.press('Enter');
  const title = `width ${started}`;
  await page.getByLabel('Title').fill(title);
  await page.keyboard.press('Enter');
  await page.getByRole('button', { name: title }).first().waitFor();
  step('measured');

  await tab('Review');
  await page.getByRole('button', { name: 'At a place in the map' }).click();
  const field = page.getByLabel('Comment', { exact: true });
  await clickGround(page, () => field.isVisible());
  await field.fill(`This does not fit ${started}`);
  await page.getByRole('button', { name: 'Comment', exact: true }).click();
  await page.getByRole('article').filter({ hasText: String(started) }).waitFor();
  await picture('comment');
  await decide('Reject', 'A loop is doubtful: build without it');
  await page.getByText('rejected', { exact: true }).first().waitFor();
  step('commented, rejected');

  await tab('Loops');
  await page.getByRole('button', { name: 'Build with these decisions' }).click();
  const built = page.getByRole('region', { name: 'The version that is being built' });
  await built.getByRole('link', { name: 'What changed after' }).waitFor({ timeout: 900_000 });
  await picture('built');
  await built.getByRole('link', { name: 'What changed after' }).click();
  await page.getByText(/Trajectories moved/).first().waitFor({ timeout: 120_000 });
  await picture('after');
  step('built a version, saw what changed');

  const next = (await json(`/sites/${name}`)).latest_version;
  await page.getByRole('link', { name: `Open version ${next}` }).click();
  await mapShown(page, `${name}/${next}`);
  await decide('Submit');
  await page.getByText('in review', { exact: true }).first().waitFor();
  await decide('Approve');
  await page.getByText('approved', { exact: true }).first().waitFor();
  await picture('approved');
  step('approved');

  assert.deepEqual(page.faults, []);
  assert.equal(next, before + 1);
  assert.equal((await json(`/sites/${name}`)).approved_version, next);
  assert.equal((await json(`/sites/${name}/maps/${before}/review`)).state, 'rejected');
  const report = await json(`/sites/${name}/maps/${next}/report.json`);
  assert.ok(report.drives.some((drive) => drive.loops.review.rejected.includes(rejected.slice(drive.name.length + 1))), 'built without the loop');
  console.log('a whole review, without the command line');
} catch (error) {
  await picture('failed');
  console.log(page.faults);
  throw error;
} finally {
  await close();
}
