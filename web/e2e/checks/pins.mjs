// Pins: where points of the map lie on Earth.
import assert from 'node:assert/strict';

import { counted, mapShown } from '../browser.mjs';
import { clickGround, viewOfGround } from '../ground.mjs';

export const checks = {
  async 'two pins by mouse and keyboard, as far as the request that builds with them'(page, world) {
    const { address, site } = world;
    const requests = [];
    await page.route('**/api/v1/sites/*/maps', (route) => {
      if (route.request().method() !== 'POST') return route.continue();
      requests.push(route.request().postDataJSON());
      return route.fulfill({ status: 202, json: { id: 'abc' } });
    });
    await page.goto(`${address}/sites/${site.name}/maps/${site.latest_version}?view=${await viewOfGround(world)}`);
    await mapShown(page, `${site.name}/${site.latest_version}`);
    await page.getByRole('tab', { name: 'Pins' }).click();
    const build = page.locator('#pin-panel .primary');
    const pinsBefore = await page.locator('#pin-panel li').count();

    await clickGround(page, () => page.locator('#pin-point').inputValue());
    const clicked = await page.locator('#pin-point').inputValue();
    assert.match(clicked, /^-?[\d.]+, -?[\d.]+, -?[\d.]+$/, 'a click on the ground gives a point');
    await page.keyboard.type('nowhere'); // the field for the place has the focus
    await page.keyboard.press('Enter');
    assert.match(await page.locator('#pin-panel [role=alert]').innerText(), /Latitude/);
    await page.locator('#pin-place').fill('48.1371, 11.5761, 519.3');
    await page.keyboard.press('Enter');
    await page.locator('#pin-panel li').nth(pinsBefore).waitFor();
    if (pinsBefore === 0) assert.match(await build.innerText(), /One more pin/);

    await page.keyboard.type('12.5, -3, 0.1');
    await page.keyboard.press('Tab');
    await page.keyboard.type('48.1372 11.5763');
    await page.keyboard.press('Enter');
    await page.locator('#pin-panel li').nth(pinsBefore + 1).waitFor();
    await world.picture('pins');
    await build.click();
    await page.getByText('In the queue').waitFor();
    const [{ from, pins }] = requests;
    assert.equal(requests.length, 1);
    assert.equal(from, site.latest_version);
    assert.equal(pins.length, pinsBefore + 2);
    assert.deepEqual(pins.at(-1), { point: [12.5, -3, 0.1], latitude: 48.1372, longitude: 11.5763 });
    assert.deepEqual(pins.at(-2).point.map((value) => value.toFixed(2)).join(', '), clicked);
    assert.equal(pins.at(-2).height, 519.3);
    assert.equal(await page.getByRole('link', { name: 'Follow the new version' }).getAttribute('href'), '/jobs/abc');

    await page.locator('#pin-place').press('Escape'); // clicks choose again
    assert.equal(await page.getByRole('button', { name: 'Click in the map' }).getAttribute('aria-pressed'), 'false');
  },

  async 'a refused build is said, and may be tried again'(page, { address, site }) {
    await page.route('**/api/v1/sites/*/maps', (route) =>
      route.request().method() === 'POST'
        ? route.fulfill({ status: 400, contentType: 'application/problem+json', json: { title: 'Bad Request', status: 400, detail: 'pins lie at least 5 m apart' } })
        : route.continue(),
    );
    await page.goto(`${address}/sites/${site.name}/maps/${site.latest_version}?tab=pins`);
    await page.locator('#pin-panel').waitFor();
    const pins = page.locator('#pin-panel ol li');
    const before = await pins.count();
    for (const [i, point] of ['0, 0, 0', '0.1, 0, 0'].entries()) {
      await page.locator('#pin-point').fill(point);
      await page.locator('#pin-place').fill('48.1, 11.5');
      await page.keyboard.press('Enter');
      await counted(pins, before + i + 1); // a person sees it before the next one is typed
    }
    const build = page.getByRole('button', { name: 'Build a version with these' });
    await build.click();
    await page.locator('#pin-panel [role=alert]').getByText('Pins lie at least 5 m apart').waitFor();
    assert.ok(await build.isEnabled());
    page.faults = page.faults.filter((fault) => !fault.includes('400')); // the browser's own note of the refusal
  },
};
