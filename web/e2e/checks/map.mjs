// The scene of a map.
import assert from 'node:assert/strict';

import { mapShown } from '../browser.mjs';

/** Distinct colors of the canvas, counted by the browser itself. */
async function countColors(page) {
  const png = (await page.locator('#canvas').screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    return new Set(new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer)).size;
  }, png);
}

export const checks = {
  async 'an address of before shows the latest map, and the address keeps the view'(page, { address, site }) {
    await page.goto(`${address}/?site=${site.name}`);
    await mapShown(page, `${site.name}/${site.latest_version}`);
    assert.equal(new URL(page.url()).pathname, `/sites/${site.name}/maps/latest`);
    await page.waitForTimeout(500);
    assert.ok((await countColors(page)) > 500, 'the canvas shows a map');
    await page.getByRole('button', { name: 'From above' }).click();
    await page.waitForFunction(() => new URLSearchParams(location.search).has('view'));
    const { width, height } = await page.locator('#canvas').boundingBox();
    await page.locator('#canvas').hover({ position: { x: width / 2, y: height / 2 } });
    const view = new URL(page.url()).searchParams.get('view');
    await page.reload();
    await mapShown(page, `${site.name}/${site.latest_version}`);
    assert.equal(new URL(page.url()).searchParams.get('view'), view);
  },

  async 'north, scale and coordinates lie over the scene, and keys move it'(page, { address, site }) {
    await page.goto(`${address}/sites/${site.name}/maps/${site.latest_version}`);
    await mapShown(page, `${site.name}/${site.latest_version}`);
    await page.getByRole('button', { name: 'From above' }).click();
    const scale = page.locator('[data-scale]');
    const before = Number(await scale.getAttribute('data-scale'));
    for (let press = 0; press < 6; ++press) await page.getByRole('button', { name: 'Closer' }).click();
    await page.waitForFunction((least) => Number(document.querySelector('[data-scale]').dataset.scale) < least, before);
    const view = () => new URL(page.url()).searchParams.get('view');
    await page.waitForFunction(() => new URLSearchParams(location.search).has('view'));
    const from = view();
    await page.locator('#canvas').focus();
    await page.keyboard.press('ArrowLeft');
    await page.waitForFunction((old) => new URLSearchParams(location.search).get('view') !== old, from);
    await page.getByRole('button', { name: 'Overview' }).click();
    const slots = await page.locator('#canvas').boundingBox();
    // Somewhere below the middle there is ground.
    const output = page.locator('output[aria-label="Under the pointer"]');
    for (let share = 0.5; share < 0.95 && (await output.count()) === 0; share += 0.05) {
      await page.mouse.move(slots.x + 0.45 * slots.width, slots.y + share * slots.height);
      await output.waitFor({ timeout: 500 }).catch(() => undefined);
    }
    assert.match(await output.innerText(), /-?\d+\.\d\d, -?\d+\.\d\d, -?\d+\.\d\d m/);
    if (site.datum) assert.match(await output.innerText(), /\d+\.\d{7}, \d+\.\d{7}/);
  },

  async 'a version that is not there says where others are'(page, { address, site }) {
    await page.goto(`${address}/sites/${site.name}/maps/99999`);
    await page.getByRole('alert').waitFor();
    page.faults.splice(0);
    await page.getByRole('link', { name: `All versions of ${site.name}` }).click();
    assert.equal(new URL(page.url()).pathname, `/sites/${site.name}`);
  },
};
