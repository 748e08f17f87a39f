// A site of any size, made of copies of a map that a service has:
//   node e2e/big_site.mjs ADDRESS --hectares 100 [--site NAME] [--listen PORT]
// stands before the service and answers as it does, but for that site's map: its tree of tiles holds as many copies as
// cover the area, each at an address of its own, and above them coarser tiles of the whole, as the exporter makes them.
// A coarse tile is the map's own overview, stretched: it weighs what such a tile weighs, and only looks like one from afar.
import { createServer, request } from 'node:http';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const kGap = 2; // [m] between copies

/** The largest site of a service that has a map. */
export async function largestSite(address, name) {
  const { items } = await (await fetch(`${address}/api/v1/sites`)).json();
  const area = ({ bounds }) => (bounds ? (bounds.max[0] - bounds.min[0]) * (bounds.max[1] - bounds.min[1]) : 0);
  const site = name ? items.find((one) => one.name === name) : items.filter((one) => one.latest_version).sort((a, b) => area(b) - area(a))[0];
  if (!site) throw new Error('this service has no such map');
  return site;
}

/** A box of a tile around [low, high]. */
const boxAround = (low, high) => {
  const half = low.map((value, axis) => (high[axis] - value) / 2);
  return [...low.map((value, axis) => value + half[axis]), half[0], 0, 0, 0, half[1], 0, 0, 0, half[2]];
};

/** Columns and rows of copies that cover the area best as a square. */
function gridOf({ min, max }, squareMeters) {
  const step = [max[0] - min[0] + kGap, max[1] - min[1] + kGap];
  const count = (axis) => Math.max(1, Math.round(Math.sqrt(squareMeters) / step[axis]));
  return { step, columns: count(0), rows: Math.max(1, Math.ceil(squareMeters / (step[0] * step[1]) / count(0))) };
}

/** The tree over copies [from, to) in both directions: halves of the longer side, down to one copy. */
function treeOver(original, bounds, step, from, to) {
  const { root } = original;
  const { min, max } = bounds;
  const [columns, rows] = [to[0] - from[0], to[1] - from[1]];
  if (columns * rows === 1) return copyOf(root, `copies/${from[0]}_${from[1]}/`, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, step[0] * from[0], step[1] * from[1], 0, 1]);
  const isWide = rows === 1 || (columns > 1 && columns * step[0] >= rows * step[1]);
  const middle = isWide ? [from[0] + Math.ceil(columns / 2), to[1]] : [to[0], from[1] + Math.ceil(rows / 2)];
  const second = isWide ? [middle[0], from[1]] : [from[0], middle[1]];
  return {
    boundingVolume: { box: boxAround([min[0] + step[0] * from[0], min[1] + step[1] * from[1], min[2]], [max[0] + step[0] * (to[0] - 1), max[1] + step[1] * (to[1] - 1), max[2]]) },
    geometricError: root.geometricError * Math.max(columns, rows),
    refine: 'REPLACE',
    content: { uri: `whole/${from.join('_')}_${to.join('_')}/${root.content.uri}` },
    children: [treeOver(original, bounds, step, from, middle), treeOver(original, bounds, step, second, to)],
  };
}

function copyOf({ transform: _, ...tile }, folder, transform) {
  return {
    ...tile,
    ...(transform ? { transform } : {}),
    ...(tile.content ? { content: { ...tile.content, uri: folder + tile.content.uri } } : {}),
    ...(tile.children ? { children: tile.children.map((child) => copyOf(child, folder)) } : {}),
  };
}

/** A GLB whose scene is stretched and moved in the plane of the ground, which is x and -z there. */
function stretched(glb, [scaleX, scaleY], [moveX, moveY]) {
  const length = glb.readUInt32LE(12);
  const json = JSON.parse(glb.subarray(20, 20 + length).toString());
  const scene = json.scenes[json.scene ?? 0];
  scene.nodes = [json.nodes.push({ name: 'stretched', scale: [scaleX, 1, scaleY], translation: [moveX, 0, -moveY], children: scene.nodes }) - 1];
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const head = Buffer.from(glb.subarray(0, 20));
  head.writeUInt32LE(glb.length - length + padded.length, 8);
  head.writeUInt32LE(padded.length, 12);
  return Buffer.concat([head, padded, glb.subarray(20 + length)]);
}

/** Serves it. Returns the address, the site that has grown, and what ends it. */
export async function serveBigSite(address, { hectares, site: name, port = 0 }) {
  const site = await largestSite(address, name);
  const folder = `/api/v1/sites/${site.name}/maps/${site.latest_version}`;
  const original = await (await fetch(`${address}${folder}/tileset.json`)).json();
  const { step, columns, rows } = gridOf(site.bounds, 1e4 * hectares);
  const grown = { min: site.bounds.min, max: [site.bounds.max[0] + step[0] * (columns - 1), site.bounds.max[1] + step[1] * (rows - 1), site.bounds.max[2]] };
  const root = treeOver(original, site.bounds, step, [0, 0], [columns, rows]);
  if (original.root.transform) root.transform = original.root.transform;
  const tileset = JSON.stringify({ ...original, geometricError: 16 * Math.max(columns, rows), root });

  const tiles = new Map();
  const tileOf = async (file) => {
    if (!tiles.has(file)) tiles.set(file, Buffer.from(await (await fetch(`${address}${folder}/${file}`)).arrayBuffer()));
    return tiles.get(file);
  };
  const answer = (response, type, body) => response.writeHead(200, { 'content-type': type, 'content-length': body.length, 'cache-control': 'no-store' }).end(body);

  async function handle(asked, response) {
    const path = decodeURIComponent(new URL(asked.url, address).pathname);
    const copy = path.match(/\/copies\/\d+_\d+\/(.*)$/);
    const whole = path.match(/\/whole\/(\d+)_(\d+)_(\d+)_(\d+)\/(.*)$/);
    if (path === `${folder}/tileset.json`) return answer(response, 'application/json', Buffer.from(tileset));
    if (copy) return answer(response, 'model/gltf-binary', await tileOf(copy[1]));
    if (whole) {
      const [fromX, fromY, toX, toY] = whole.slice(1, 5).map(Number);
      const scale = [toX - fromX, toY - fromY];
      const { min } = site.bounds; // stays where it is
      const move = [fromX * step[0] + min[0] * (1 - scale[0]), fromY * step[1] + min[1] * (1 - scale[1])];
      return answer(response, 'model/gltf-binary', stretched(await tileOf(whole[5]), scale, move));
    }
    const isMap = path.startsWith(`/api/v1/sites/${site.name}/maps/`) && path.split('/').length === 7;
    if (isMap && asked.method === 'GET') {
      const map = await (await fetch(address + asked.url)).json();
      return answer(response, 'application/json', Buffer.from(JSON.stringify({ ...map, bounds: grown })));
    }
    const { port: toPort, hostname, host } = new URL(address);
    asked.pipe(
      request({ hostname, port: toPort, path: asked.url, method: asked.method, headers: { ...asked.headers, host } }, (from) => {
        response.writeHead(from.statusCode, from.headers);
        from.pipe(response);
      }).on('error', () => response.destroy()),
    );
  }
  const server = createServer((asked, response) => void handle(asked, response).catch(() => response.destroy()));
  await new Promise((resolve) => server.listen(port, '127.0.0.1', resolve));
  return {
    address: `http://127.0.0.1:${server.address().port}`,
    site,
    copies: columns * rows,
    close: () => (server.closeAllConnections(), server.close()),
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { values, positionals } = parseArgs({ allowPositionals: true, options: { site: { type: 'string' }, hectares: { type: 'string', default: '100' }, listen: { type: 'string', default: '0' } } });
  const address = positionals[0]?.replace(/\/$/, '');
  if (!address) throw new Error('usage: node e2e/big_site.mjs ADDRESS [--hectares 100] [--site NAME] [--listen PORT]');
  const big = await serveBigSite(address, { hectares: Number(values.hectares), site: values.site, port: Number(values.listen) });
  console.log(`${big.copies} copies of ${big.site.name}: ${big.address}/sites/${big.site.name}/maps/latest`);
}
