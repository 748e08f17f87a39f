// What changed between two versions, and between two drives of one.
import assert from 'node:assert/strict';

const shown = (page, name) => page.waitForFunction((wanted) => document.body.dataset.shown === wanted, name, { timeout: 60_000 });

/** Opens the comparison of the last two versions. */
async function open(page, world, query = '') {
  const { name, versions } = world.site ?? { versions: [] };
  if (versions.length < 2) world.skip('no site with two versions');
  const [from, to] = [...versions].sort((a, b) => a - b).slice(-2);
  await page.goto(`${world.address}/sites/${encodeURIComponent(name)}/compare?from=${from}&to=${to}${query}`);
  await shown(page, `${name}/${from}-${to}`);
  return { name, from, to, comparison: await world.json(`/api/v1/sites/${encodeURIComponent(name)}/compare?from=${from}&to=${to}`) };
}

/** How many colors a canvas shows. */
async function countColors(page, label) {
  const png = (await page.screenshot({ clip: await page.getByLabel(label).boundingBox() })).toString('base64');
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

const query = (page) => new URL(page.url()).searchParams;
const mode = (page, title) => page.getByRole('group', { name: 'How both are shown' }).getByRole('button', { name: title });

export const checks = {
  async 'both versions are shown, and changes are stepped through by keys'(page, world) {
    const { from, to, comparison } = await open(page, world);
    for (const version of [from, to]) assert.ok((await countColors(page, `Version ${version} in 3-D`)) > 100, `version ${version} is drawn`);
    const { slots, regions } = comparison;
    const count = regions.length + slots.added.length + slots.removed.length + slots.changed.length;
    await page.getByRole('heading', { name: count === 1 ? '1 change' : `${count} changes` }).waitFor();
    if (count < 2) world.skip('fewer than two changes');
    const before = query(page).get('view');
    await page.keyboard.press('j');
    await page.keyboard.press('j');
    await page.getByText(`2 of ${count}`).waitFor();
    const second = query(page).get('change');
    await page.waitForFunction((was) => (new URLSearchParams(location.search).get('view') ?? '') !== (was ?? ''), before);
    await page.keyboard.press('k');
    await page.getByText(`1 of ${count}`).waitFor();
    assert.notEqual(query(page).get('change'), second);
    await page.reload(); // the address holds what was chosen
    await page.getByText(`1 of ${count}`).waitFor();
    await world.picture('compare_side');
  },

  async 'the divider of a swipe moves by keys and by dragging'(page, world) {
    await open(page, world, '&mode=swipe');
    const divider = page.getByRole('slider', { name: 'Divider' });
    await divider.focus();
    await page.keyboard.press('ArrowLeft');
    assert.equal(await divider.getAttribute('aria-valuenow'), '48');
    await page.keyboard.press('End');
    assert.equal(await divider.getAttribute('aria-valuenow'), '100');
    await page.keyboard.press('Home');
    const { x, y, width, height } = await divider.boundingBox();
    await page.mouse.move(x + width - 4, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + 200, y + height / 2);
    await page.mouse.up();
    assert.ok(Number(await divider.getAttribute('aria-valuenow')) > 10);
  },

  async 'heights come with a legend, whose range can be chosen; the address keeps the mode'(page, world) {
    await open(page, world);
    await page.keyboard.press('4');
    const range = page.getByLabel('Range of the colors');
    await range.waitFor({ timeout: 60_000 });
    await range.selectOption({ label: '± 50 cm' });
    await page.getByText('+50 cm, higher').waitFor();
    assert.equal(query(page).get('mode'), 'heights');
    await world.picture('compare_heights');
    await mode(page, 'Overlay').click();
    await page.getByLabel('How much of the earlier version is seen').waitFor();
    assert.equal(await range.count(), 0);
  },

  async 'a ground that cannot be loaded is told where heights were wanted'(page, world) {
    await page.route('**/ground.ply', (route) => route.fulfill({ status: 404, body: '' }));
    await open(page, world, '&mode=heights');
    await page.getByRole('alert').filter({ hasText: 'Heights cannot be shown' }).waitFor();
    page.faults.length = 0; // the refusal is told on the console
  },

  async 'a version that is not there is refused in words'(page, world) {
    if (!world.site) world.skip('no site');
    await page.goto(`${world.address}/sites/${encodeURIComponent(world.site.name)}/compare?from=987654&to=${world.site.latest_version}`);
    await page.getByRole('alert').waitFor();
    await page.getByRole('button', { name: 'Try again' }).waitFor();
    page.faults.length = 0;
  },

  async 'a site with one version says what to do next'(page, world) {
    if (!world.site) world.skip('no site');
    const route = `/api/v1/sites/${encodeURIComponent(world.site.name)}/maps`;
    const { items } = await world.json(route);
    await page.route(`**${route}?*`, (request) => request.fulfill({ json: { items: items.slice(0, 1), next_cursor: null } }));
    await page.goto(`${world.address}/sites/${encodeURIComponent(world.site.name)}/compare`);
    await page.getByRole('heading', { name: 'There is nothing to compare yet' }).waitFor();
    await page.getByRole('link', { name: 'Review loops' }).waitFor();
  },

  async 'two drives of a version are compared by the slots that both saw'(page, world) {
    if (!world.site) world.skip('no site');
    const { name, latest_version: version } = world.site;
    const { drives } = await world.json(`/api/v1/sites/${encodeURIComponent(name)}/maps/${version}`);
    await page.goto(`${world.address}/sites/${encodeURIComponent(name)}/compare`);
    await page.getByRole('group', { name: 'What is compared' }).getByRole('button', { name: 'Drives' }).click();
    if (drives.length < 2) return page.getByRole('heading', { name: `Version ${version} is of one drive` }).waitFor();
    await shown(page, `${name}/${version}`);
    await page.getByText('slots were seen by both').waitFor();
    assert.equal(query(page).get('of'), 'sessions');
  },
};
