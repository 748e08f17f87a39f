// What lies under the sites: pictures of a tile server, and a file of PMTiles that the service hands out in pieces.
import assert from 'node:assert/strict';

const kEvery = 4; // th pixel is looked at
const describe = (page, basemap) => page.route('**/viewer.json', (route) => route.fulfill({ json: { basemap } }));

async function open(page, { address, sites, skip }) {
  if (!sites.some(({ datum }) => datum)) skip('no site lies on Earth');
  await page.goto(`${address}/sites`);
  await page.waitForSelector('[data-overview="drawn"]', { timeout: 60_000 });
}

/** How much of the overview has a color, [share of its pixels]. */
async function shareOf(page, [red, green, blue]) {
  const png = (await page.locator('.maplibregl-canvas').screenshot()).toString('base64');
  return page.evaluate(
    async ({ png, wanted, every }) => {
      const image = new Image();
      image.src = `data:image/png;base64,${png}`;
      await image.decode();
      const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
      context.drawImage(image, 0, 0);
      const { data } = context.getImageData(0, 0, image.width, image.height);
      let count = 0;
      for (let i = 0; i < data.length; i += 4 * every) count += wanted.every((value, channel) => Math.abs(data[i + channel] - value) < 12) ? 1 : 0;
      return (count * 4 * every) / data.length;
    },
    { png, wanted: [red, green, blue], every: kEvery },
  );
}

async function waitForColor(page, color) {
  let share = 0;
  for (let i = 0; i < 60 && share < 0.4; ++i) {
    share = await shareOf(page, color);
    if (share < 0.4) await page.waitForTimeout(250);
  }
  assert.ok(share >= 0.4, `${(100 * share).toFixed(0)} % of the map have the color of the basemap`);
}

/** Bytes of a number as protocol buffers and PMTiles have it. */
function varint(value) {
  const bytes = [];
  for (; value > 127; value >>>= 7) bytes.push((value & 127) | 128);
  return [...bytes, value];
}
const field = (number, bytes) => [...varint((number << 3) | 2), ...varint(bytes.length), ...bytes];
const count = (number, value) => [...varint(number << 3), ...varint(value)];
const words = (text) => [...Buffer.from(text)];

/** A vector tile that is all water. */
function waterTile() {
  const zigzag = (value) => (value << 1) ^ (value >> 31);
  const corners = [[-64, -64], [4224, 0], [0, 4224], [-4224, 0]]; // steps; the tile has 4096 and a border
  const steps = corners.flatMap(([x, y], i) => [...(i === 0 ? [9] : i === 1 ? [26] : []), zigzag(x), zigzag(y)]);
  const polygon = [...count(3, 3), ...field(4, [...steps, 15].flatMap(varint))];
  return Buffer.from(field(3, [...count(15, 2), ...field(1, words('water')), ...field(2, polygon), ...count(5, 4096)]));
}

/** An archive of one tile, the whole world: https://github.com/protomaps/PMTiles, version 3. */
function pmtilesOf(tile) {
  const kHeader = 127;
  const directory = Buffer.from([1, 0, 1, ...varint(tile.length), 1]); // one entry: its id, run, length, offset
  const metadata = Buffer.from(JSON.stringify({ vector_layers: [{ id: 'water', fields: {} }] }));
  const header = Buffer.alloc(kHeader);
  header.write('PMTiles');
  header[7] = 3;
  const tilesAt = kHeader + directory.length + metadata.length;
  [kHeader, directory.length, kHeader + directory.length, metadata.length, tilesAt, 0, tilesAt, tile.length, 1, 1, 1].forEach((value, i) =>
    header.writeBigUInt64LE(BigInt(value), 8 + 8 * i),
  );
  header.set([1, 1, 1, 1, 0, 0], 96); // clustered; directories and tiles not packed; vectors; zoom 0 to 0
  [-1800000000, -850000000, 1800000000, 850000000].forEach((value, i) => header.writeInt32LE(value, 102 + 4 * i));
  return Buffer.concat([header, directory, metadata, tile]);
}

export const checks = {
  async 'tiles of a server lie under the sites, and who made them is said'(page, world) {
    const png = await page.evaluate(() => {
      const canvas = Object.assign(document.createElement('canvas'), { width: 256, height: 256 });
      const context = canvas.getContext('2d');
      context.fillStyle = 'rgb(200, 40, 160)';
      context.fillRect(0, 0, 256, 256);
      return canvas.toDataURL().split(',')[1];
    });
    const asked = new Set();
    await page.route('**/basemap-of-a-check/**', (route) => {
      asked.add(new URL(route.request().url()).pathname);
      return route.fulfill({ contentType: 'image/png', body: Buffer.from(png, 'base64') });
    });
    await describe(page, { tiles: `${world.address}/basemap-of-a-check/{z}/{x}/{y}.png`, attribution: 'The Town' });
    await open(page, world);
    await waitForColor(page, [200, 40, 160]);
    assert.ok([...asked].every((path) => /\/\d+\/\d+\/\d+\.png$/.test(path)), [...asked].join(' '));
    await page.locator('.maplibregl-ctrl-attrib').getByText('The Town').waitFor();
    await page.locator('.grid-labels').waitFor({ state: 'hidden' });
    await world.picture('basemap_tiles');
  },

  async 'a file of PMTiles is read in pieces and drawn in the colors of the page'(page, world) {
    const archive = pmtilesOf(waterTile());
    const ranges = [];
    await page.route('**/basemap.pmtiles', (route) => {
      const range = route.request().headers()['range'] ?? '';
      const [, from, to] = /^bytes=(\d+)-(\d+)$/.exec(range) ?? [];
      if (from === undefined) return route.fulfill({ status: 400 });
      ranges.push(range);
      const body = archive.subarray(Number(from), Number(to) + 1);
      const end = Number(from) + body.length - 1;
      return route.fulfill({ status: 206, headers: { 'content-range': `bytes ${from}-${end}/${archive.length}`, etag: '"one"' }, contentType: 'application/vnd.pmtiles', body });
    });
    await describe(page, { pmtiles: '/basemap.pmtiles', attribution: '' });
    await open(page, world);
    const water = await page.evaluate(() => {
      const probe = document.body.appendChild(document.createElement('span'));
      probe.style.color = 'var(--accent-soft)';
      const { color } = getComputedStyle(probe);
      probe.remove();
      return color.match(/\d+/g).slice(0, 3).map(Number);
    });
    await waitForColor(page, water);
    assert.ok(ranges.length > 0);
    await world.picture('basemap_pmtiles');
  },

  async 'a tile server that refuses is said, and the grid stays'(page, world) {
    await page.route('**/basemap-of-a-check/**', (route) => route.fulfill({ status: 401 }));
    await describe(page, { tiles: `${world.address}/basemap-of-a-check/{z}/{x}/{y}.png` });
    await open(page, world);
    await page.getByRole('alert').filter({ hasText: 'its server answers 401' }).waitFor();
    assert.ok(await page.locator('.grid-labels').isVisible());
    page.faults.splice(0, page.faults.length, ...page.faults.filter((fault) => !fault.includes('status of 401')));
  },

  async 'a basemap that cannot be had is said, and the sites are there'(page, world) {
    await describe(page, { tiles: 'https://tiles.example/no-places.png' });
    await open(page, world);
    await page.getByRole('alert').filter({ hasText: '"tiles" must be an address with {z}, {x} and {y}' }).waitFor();
    await page.locator(`[data-site-row="${world.site.name}"]`).waitFor();
  },
};
