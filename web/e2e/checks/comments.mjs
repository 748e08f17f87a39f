// Comments on a time of a drive and on a loop, from the part of the page that shows it to the end: written, found again, resolved.
import assert from 'node:assert/strict';

import { mapShown } from '../browser.mjs';

const threadOf = (page, text) => page.getByRole('article').filter({ hasText: text });
const isChosen = (thread) => thread.locator('.head[aria-pressed="true"]').waitFor();

/** Deletes what a check wrote, also where it failed midway. */
async function withoutTraces({ address }, route, text, check) {
  try {
    await check();
  } finally {
    const { items } = await (await fetch(`${address}/api/v1${route}/comments`)).json();
    for (const { id } of items.filter((comment) => comment.text === text)) await fetch(`${address}/api/v1${route}/comments/${id}`, { method: 'DELETE' });
  }
}

async function write(page, about, text) {
  await page.getByRole('tab', { name: 'Review' }).click();
  await page.getByRole('region', { name: 'Comments' }).waitFor();
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press('c');
  const form = page.getByRole('form', { name: 'New comment' });
  await form.getByRole('radio', { name: about }).check();
  await form.getByLabel('Comment', { exact: true }).fill(text);
  await form.getByRole('button', { name: 'Comment', exact: true }).click();
  await isChosen(threadOf(page, text));
}

async function resolve(page, text) {
  const thread = threadOf(page, text);
  await thread.getByRole('button', { name: 'Resolve' }).click();
  await thread.getByText('resolved', { exact: true }).waitFor();
}

export const checks = {
  async 'a comment on a time leads back to that time'(page, world) {
    const { address, site, json } = world;
    const route = `/sites/${site.name}/maps/${site.latest_version}`;
    const [drive] = (await json.call({ address }, `/api/v1${route}`)).drives;
    const plots = await json.call({ address }, `/api/v1/drives/${drive.id}/plots?version=${site.latest_version}&points=50`).catch(() => world.skip('its first drive has no plots'));
    const at = (plots.end / 2).toFixed(1);
    const text = `A shadow crosses ${Date.now()}`;
    await withoutTraces(world, route, text, async () => {
      await page.goto(`${address}${route}?tab=time&drive=${drive.id}&t=${at}`);
      await page.getByRole('slider', { name: 'Time of the drive' }).waitFor();
      await write(page, `The time: ${drive.name} at ${at} s`, text);
      await threadOf(page, text).getByText(`${drive.name} at ${at} s`).waitFor();

      await page.getByRole('tab', { name: 'Time' }).click();
      const slider = page.getByRole('slider', { name: 'Time of the drive' });
      await page.locator('.plot canvas').nth(1).waitFor(); // its keyframes, to which keys step, come with these
      await slider.focus();
      for (let press = 0; press < 3; ++press) await page.keyboard.press('ArrowLeft');
      await page.waitForFunction((before) => Number(new URLSearchParams(location.search).get('t')) < before - 0.1, Number(at));
      await page.getByRole('tab', { name: 'Review' }).click();
      await threadOf(page, text).locator('.head').click();
      await page.waitForFunction((wanted) => Math.abs(Number(new URLSearchParams(location.search).get('t')) - wanted) < 0.06, Number(at));
      await resolve(page, text);
    });
  },

  async 'a comment on a loop is found by its address'(page, world) {
    const { address, sites } = world;
    for (const site of sites.filter((one) => one.latest_version !== null)) {
      const route = `/sites/${site.name}/maps/${site.latest_version}`;
      const { drives, join } = await world.json(`/api/v1${route}/report.json`);
      const hasPairs = drives.some(({ loops }) => loops?.candidates.length > 0) || join?.pairs.some(({ links }) => links.length > 0);
      if (!hasPairs) continue;
      const text = `The same wall twice ${Date.now()}`;
      return withoutTraces(world, route, text, async () => {
        await page.goto(`${address}${route}?tab=loops`);
        await page.getByRole('list', { name: 'Loops and links, by doubt' }).getByRole('button').first().click();
        await page.waitForFunction(() => new URLSearchParams(location.search).get('chosen')?.startsWith('loop:'));
        await page.getByRole('article', { name: 'Chosen pair' }).locator('figure').nth(1).waitFor();
        const loop = /^loop:([^@]+)/.exec(new URL(page.url()).searchParams.get('chosen'))[1];
        await write(page, `What is chosen: loop ${loop}`, text);
        const { items } = await world.json(`/api/v1${route}/comments`);
        const written = items.find((comment) => comment.text === text);
        assert.equal(written.pin.loop, loop);

        await page.goto(`${address}${route}?tab=review&comment=${written.id}`);
        await mapShown(page, `${site.name}/${site.latest_version}`);
        await isChosen(threadOf(page, text));
        await threadOf(page, text).getByText(`loop ${loop}`).waitFor();
        await resolve(page, text);
      });
    }
    world.skip('no map has loops or links');
  },
};
