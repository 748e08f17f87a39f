// Drives the viewer in headless Chromium: node browser_test.mjs URL [SCREENSHOT.png]
// The service at URL must have at least one drive with a map.
import assert from 'node:assert/strict';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';

import { chromium } from 'playwright-core';

const [url, screenshotPath = 'viewer.png'] = process.argv.slice(2);
assert(url, 'usage: node browser_test.mjs URL [SCREENSHOT.png]');

const profile = await mkdtemp(path.join(tmpdir(), 'parkade-chromium-'));
const browser = await chromium.launchPersistentContext(profile, {
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  viewport: { width: 1280, height: 800 },
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});

// Distinct colors in a screenshot of the canvas, counted by the browser itself.
async function countColors(page) {
  const png = (await page.locator('#canvas').screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const pixels = new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer);
    return new Set(pixels).size;
  }, png);
}

// Two pins by mouse and keyboard, as far as the request that builds with them.
async function checkPins(page) {
  const requests = [];
  await page.route('**/api/v1/sites/*/maps', (route) => {
    if (route.request().method() !== 'POST') return route.continue();
    requests.push(route.request().postDataJSON());
    return route.fulfill({ status: 202, json: {} });
  });
  await page.getByRole('button', { name: 'Pins' }).click();
  const build = page.locator('#pin-panel .primary');
  const { width, height } = await page.locator('#canvas').boundingBox();
  const pinsBefore = await page.locator('#pin-panel li').count();

  // The panel covers the right; the ground lies in the middle. Not every pixel of it is ground.
  for (const [x, y] of [[0.5, 0.4], [0.45, 0.45], [0.55, 0.35], [0.4, 0.5], [0.5, 0.55]]) {
    await page.locator('#canvas').click({ position: { x: x * width, y: y * height } });
    if (await page.locator('#pin-point').inputValue()) break;
  }
  const clicked = await page.locator('#pin-point').inputValue();
  assert.match(clicked, /^-?[\d.]+, -?[\d.]+, -?[\d.]+$/, 'a click on the ground gives a point');
  await page.keyboard.type('nowhere'); // the field for the place has the focus
  await page.keyboard.press('Enter');
  assert.match(await page.locator('#pin-panel [role=alert]').innerText(), /Latitude/);
  await page.locator('#pin-place').fill('48.1371, 11.5761, 519.3');
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('#pin-panel li').count(), pinsBefore + 1);
  if (pinsBefore === 0) assert.match(await build.innerText(), /One more pin/);

  await page.keyboard.type('12.5, -3, 0.1');
  await page.keyboard.press('Tab');
  await page.keyboard.type('48.1372 11.5763');
  await page.keyboard.press('Enter');
  await page.waitForTimeout(300);
  await page.screenshot({ path: screenshotPath.replace(/\.png$/, '_pins.png') });
  await build.click();
  await page.getByText('In the queue').waitFor();
  const { from, pins } = requests[0];
  assert.equal(requests.length, 1);
  assert.ok(from >= 1);
  assert.equal(pins.length, pinsBefore + 2);
  assert.deepEqual(pins.at(-1), { point: [12.5, -3, 0.1], latitude: 48.1372, longitude: 11.5763 });
  assert.deepEqual(pins.at(-2).point.map((value) => value.toFixed(2)).join(', '), clicked);
  assert.equal(pins.at(-2).height, 519.3);
  await page.locator('#pin-place').press('Escape');
  assert(await page.locator('#pin-panel').isHidden());
}

try {
  const page = await browser.newPage();
  const complaints = [];
  page.on('console', (line) => line.type() === 'error' && complaints.push(line.text()));
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('requestfailed', (request) => !request.url().endsWith('/events') && complaints.push(`${request.url()} failed`));

  await page.goto(url);
  await page.waitForSelector('body[data-shown]', { timeout: 60_000 });
  await page.waitForTimeout(500);
  await page.screenshot({ path: screenshotPath });

  assert.equal(await page.locator('.drive .state.ready').first().textContent(), 'ready');
  assert.match(await page.locator('#map-panel').innerText(), /m²/);
  const withGround = await countColors(page);
  assert(withGround > 500, `the canvas shows only ${withGround} colors`);

  await page.getByRole('button', { name: 'Ground' }).click();
  await page.waitForTimeout(300);
  const withoutGround = await countColors(page);
  assert(withoutGround < withGround / 2, `hiding the ground leaves ${withoutGround} of ${withGround} colors`);
  await page.getByRole('button', { name: 'Ground' }).click();
  await page.getByRole('button', { name: 'From above' }).click();
  await page.waitForTimeout(300);
  await page.screenshot({ path: screenshotPath.replace(/\.png$/, '_above.png') });

  await checkPins(page);

  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('link', { name: /^map\.glb/ }).click(),
  ]);
  assert.equal(await download.failure(), null);
  assert.deepEqual(complaints, []);
  console.log(`viewer: ${withGround} colors, no complaints, ${screenshotPath}`);
} finally {
  await browser.close();
  await rm(profile, { recursive: true, force: true });
}
