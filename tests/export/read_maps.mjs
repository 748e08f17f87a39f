// Reads the maps that parkade_export_example wrote with programs that are not ours: Khronos' glTF validator,
// glTF-Transform and Google's Draco decoder.   node read_maps.mjs FOLDER
import { strict as assert } from 'node:assert';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const folder = process.argv[2];
if (!existsSync(new URL('./node_modules', import.meta.url))) {
  console.log('skipped: no node_modules; run npm ci in tests/export');
  process.exit(77);
}
const { NodeIO, getBounds } = await import('@gltf-transform/core');
const { KHRDracoMeshCompression, KHRMaterialsUnlit } = await import('@gltf-transform/extensions');
const { default: draco3d } = await import('draco3dgltf');
const { default: validator } = await import('gltf-validator');

const io = new NodeIO()
  .registerExtensions([KHRDracoMeshCompression, KHRMaterialsUnlit])
  .registerDependencies({ 'draco3d.decoder': await draco3d.createDecoderModule() });

/** Fails on any error or warning of the validator, but for those of codes in `allowed`. */
async function validate(bytes, name, allowed = []) {
  const report = await validator.validateBytes(new Uint8Array(bytes), { uri: name, maxIssues: 20 });
  const issues = report.issues.messages.filter((m) => m.severity <= 1 && !allowed.includes(m.code));
  assert.deepEqual(issues, [], `${name}: ${JSON.stringify(issues, null, 1)}`);
  return report;
}

/** The document as it is after decoding. */
async function decode(bytes, name) {
  const document = await io.readBinary(new Uint8Array(bytes));
  document.getRoot().listExtensionsUsed().find((e) => e.extensionName === 'KHR_draco_mesh_compression')?.dispose();
  await validate(await io.writeBinary(document), `${name}, decoded`);
  return document;
}

const nodeOf = (document, name) => document.getRoot().listNodes().find((node) => node.getName() === name);
const groundOf = (document) => nodeOf(document, 'ground').getMesh()?.listPrimitives()[0];
const jsonOf = (bytes) => JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());

/** Rows of numbers of an accessor, in an order that does not depend on the compressor's. */
function vertices(primitive) {
  const rows = [];
  for (let i = 0; i < primitive.getAttribute('POSITION').getCount(); ++i) {
    rows.push({
      position: primitive.getAttribute('POSITION').getElement(i, []),
      normal: primitive.getAttribute('NORMAL').getElement(i, []),
      color: primitive.getAttribute('COLOR_0').getElement(i, []),
      sigma: primitive.getAttribute('_HEIGHT_SIGMA').getScalar(i),
    });
  }
  return rows;
}

const distance = (a, b) => Math.hypot(...a.map((value, i) => value - b[i]));

/** Each vertex of `a` has one of `b` within `tolerance` [m], and is of the same color, normal and sigma. */
function compareVertices(a, b, tolerance) {
  const cell = 0.05;
  const keyOf = (position, dx, dy, dz) =>
    `${Math.floor(position[0] / cell) + dx},${Math.floor(position[1] / cell) + dy},${Math.floor(position[2] / cell) + dz}`;
  const grid = new Map();
  for (const vertex of b) {
    const key = keyOf(vertex.position, 0, 0, 0);
    grid.set(key, [...(grid.get(key) ?? []), vertex]);
  }
  let worst = 0;
  for (const vertex of a) {
    let nearest = null;
    for (let i = 0; i < 27; ++i)
      for (const other of grid.get(keyOf(vertex.position, (i % 3) - 1, (Math.floor(i / 3) % 3) - 1, Math.floor(i / 9) - 1)) ?? [])
        if (!nearest || distance(vertex.position, other.position) < distance(vertex.position, nearest.position)) nearest = other;
    assert.ok(nearest, `no vertex near ${vertex.position}`);
    worst = Math.max(worst, distance(vertex.position, nearest.position));
    assert.ok(distance(vertex.color, nearest.color) < 1e-6, 'colors differ');
    assert.ok(distance(vertex.normal, nearest.normal) < 0.02, 'normals differ');
    assert.ok(Math.abs(vertex.sigma - nearest.sigma) < 1e-4, 'sigmas differ');
  }
  assert.ok(worst <= tolerance, `positions differ by ${worst} m`);
  return worst;
}

/** Sum of the triangles' areas [m^2] and of their upward parts. */
function areas(primitive) {
  const position = primitive.getAttribute('POSITION');
  const indices = primitive.getIndices();
  let area = 0;
  let upward = 0;
  for (let i = 0; i < indices.getCount(); i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => position.getElement(indices.getScalar(i + k), []));
    const u = b.map((value, k) => value - a[k]);
    const v = c.map((value, k) => value - a[k]);
    const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    area += 0.5 * Math.hypot(...cross);
    upward += 0.5 * cross[1];
  }
  return { area, upward };
}

async function checkGround(name, plainBytes, dracoBytes) {
  const plain = await decode(plainBytes, `${name}/map_plain.glb`);
  const draco = await decode(dracoBytes, `${name}/map.glb`);
  const [a, b] = [groundOf(plain), groundOf(draco)];
  const count = (primitive) => [primitive.getAttribute('POSITION').getCount(), primitive.getIndices().getCount() / 3];
  assert.deepEqual(count(b), count(a), 'vertex or triangle counts differ');
  // What the file said before decoding.
  const json = jsonOf(dracoBytes);
  const primitive = json.meshes[0].primitives[0];
  assert.equal(json.accessors[primitive.attributes.POSITION].count, count(b)[0]);
  assert.equal(json.accessors[primitive.indices].count, 3 * count(b)[1]);
  assert.ok(json.extensionsRequired.includes('KHR_draco_mesh_compression'));
  assert.equal(json.accessors[primitive.attributes.POSITION].bufferView, undefined);

  const worst = compareVertices(vertices(a), vertices(b), 0.002);
  const [before, after] = [areas(a), areas(b)];
  assert.ok(Math.abs(before.area - after.area) < 1e-3 * before.area, 'areas differ');
  assert.ok(before.upward > 0.95 * before.area, 'the ground does not face up in y-up');
  assert.ok(after.upward > 0.95 * after.area, 'the compressed ground does not face up in y-up');
  assert.ok(dracoBytes.length * 4 < plainBytes.length, 'Draco does not compress');
  console.log(`${name}: ${count(a)[0]} vertices, ${count(a)[1]} triangles, ${plainBytes.length} -> ` +
              `${dracoBytes.length} bytes, at most ${(1000 * worst).toFixed(2)} mm off`);
  return plain;
}

function checkScene(document, bytes, isGeoreferenced) {
  const scene = document.getRoot().listScenes()[0];
  assert.deepEqual(scene.listChildren().map((node) => node.getName()), ['site']);
  const names = nodeOf(document, 'site').listChildren().map((node) => node.getName());
  assert.deepEqual(names, ['ground', 'drive:monday', 'drive:tuesday_2']);
  const monday = nodeOf(document, 'drive:monday').getMesh().listPrimitives()[0];
  assert.equal(monday.getMode(), 3, 'a drive is a line strip');
  // A circle of 8 m around the site's origin, y up.
  const bounds = getBounds(nodeOf(document, 'drive:monday'));
  for (const axis of [0, 2]) {
    assert.ok(Math.abs(bounds.max[axis] - 8) < 0.05 && Math.abs(bounds.min[axis] + 8) < 0.05, `${bounds.min} ${bounds.max}`);
  }
  assert.ok(Math.abs(bounds.max[1]) < 0.1);
  const { extras } = jsonOf(bytes).asset;
  assert.deepEqual(extras.gltf_from_site, [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1]);
  if (isGeoreferenced) {
    assert.deepEqual(extras.georeference.origin, [48.1372, 11.5756, 520]);
    assert.equal(extras.georeference.crs, 'EPSG:4979');
  } else {
    assert.equal(extras.georeference, undefined);
  }
}

/** Each piece has a JPEG, and its texture coordinates say where its vertices are (see MakeTexturedMap). */
async function checkTexture(name, bytes, expectedTriangles) {
  const document = await decode(bytes, name);
  const node = nodeOf(document, 'ground');
  const [tx, , tz] = node.getTranslation();
  let triangles = 0;
  for (const primitive of node.getMesh().listPrimitives()) {
    const texture = primitive.getMaterial().getBaseColorTexture();
    assert.equal(texture.getMimeType(), 'image/jpeg');
    assert.deepEqual(texture.getSize(), [500, 300]);
    assert.equal(primitive.getAttribute('COLOR_0'), null, 'colors would darken the texture');
    const [position, texcoord] = ['POSITION', 'TEXCOORD_0'].map((key) => primitive.getAttribute(key));
    for (let i = 0; i < position.getCount(); ++i) {
      const [x, , z] = position.getElement(i, []);
      const [u, v] = texcoord.getElement(i, []);
      assert.ok(Math.abs(-25 + 50 * u - (x + tx)) < 0.01, `u ${u} at x ${x + tx}`);
      assert.ok(Math.abs(15 - 30 * v + (z + tz)) < 0.01, `v ${v} at y ${-(z + tz)}`);
    }
    triangles += primitive.getIndices().getCount() / 3;
  }
  assert.equal(triangles, expectedTriangles, `${name}: the pieces together are not the mesh`);
}

/** Draco splits vertices where the surface is no manifold; the file must say how many there are then. */
async function checkNoManifold(bytes) {
  const ground = groundOf(await decode(bytes, 'no_manifold/map.glb'));
  const json = jsonOf(bytes);
  const { attributes, indices } = json.meshes[0].primitives[0];
  assert.equal(ground.getIndices().getCount(), 3 * 4);
  assert.equal(json.accessors[indices].count, 3 * 4);
  assert.ok(ground.getAttribute('POSITION').getCount() > 7);
  assert.equal(json.accessors[attributes.POSITION].count, ground.getAttribute('POSITION').getCount());
}

/** Site coordinates of all vertices of a tile: y-up glTF to z-up. */
function tilePoints(document) {
  const node = nodeOf(document, 'ground');
  const [tx, ty, tz] = node.getTranslation();
  const position = groundOf(document).getAttribute('POSITION');
  return Array.from({ length: position.getCount() }, (_, i) => position.getElement(i, []))
    .map(([x, y, z]) => [x + tx, -(z + tz), y + ty]);
}

async function checkTiles(path, ground, isGeoreferenced) {
  const tileset = JSON.parse(readFileSync(join(path, 'tileset.json')));
  assert.equal(tileset.asset.version, '1.1');
  const { root } = tileset;
  assert.equal(root.transform !== undefined, isGeoreferenced);
  if (isGeoreferenced) {
    const [x, y, z] = root.transform.slice(12, 15);
    const radius = Math.hypot(x, y, z);
    assert.ok(radius > 6.356e6 && radius < 6.379e6);
    assert.ok(Math.abs(Math.atan2(y, x) * 180 / Math.PI - 11.5756) < 1e-9);
    // The third column is up: away from the earth.
    const up = root.transform.slice(8, 11);
    assert.ok((up[0] * x + up[1] * y + up[2] * z) / radius > 0.999);
  }
  let triangles = 0;
  let numFinest = 0;
  const seams = new Map();
  const isWithin = (inner, outer) =>
    [0, 1, 2].every((k) => Math.abs(inner[k] - outer[k]) + inner[3 + 4 * k] < outer[3 + 4 * k] + 1e-6);
  /** Reads a tile and all that replaces it; -> triangles of this tile. */
  const visit = async (tile) => {
    const bytes = readFileSync(join(path, tile.content.uri));
    const document = await decode(bytes, tile.content.uri);
    const [cx, cy, cz, hx, , , , hy, , , , hz] = tile.boundingVolume.box;
    const isFinest = tile.children === undefined;
    for (const [x, y, z] of tilePoints(document)) {
      const isInside = Math.abs(x - cx) < hx + 0.003 && Math.abs(y - cy) < hy + 0.003 && Math.abs(z - cz) < hz + 0.003;
      assert.ok(isInside, `${tile.content.uri}: a vertex outside of its box`);
      if (isFinest) {
        const near = `${x.toFixed(2)} ${y.toFixed(2)} ${z.toFixed(2)}`;
        seams.set(near, [...(seams.get(near) ?? []), [x, y, z]]);
      }
    }
    const primitives = nodeOf(document, 'ground').getMesh().listPrimitives();
    const count = primitives.reduce((sum, primitive) => sum + primitive.getIndices().getCount() / 3, 0);
    if (isFinest) {
      triangles += count;
      numFinest += 1;
      assert.equal(tile.geometricError, 0);
      return count;
    }
    let finer = 0;
    for (const child of tile.children) {
      assert.ok(child.geometricError < tile.geometricError, 'a finer tile errs more');
      assert.ok(isWithin(child.boundingVolume.box, tile.boundingVolume.box), 'a finer tile leaves its box');
      finer += await visit(child);
    }
    assert.ok(count > 0 && count < finer, `${tile.content.uri} is not smaller than what replaces it`);
    return count;
  };
  assert.equal(root.content.uri, 'tiles/overview.glb');
  assert.ok((await visit(root)) < ground / 4, 'the overview is not smaller');
  assert.equal(triangles, ground, 'the tiles together are not the mesh');
  assert.ok(numFinest >= 4);
  // Draco's encoder keeps six decimals of the lattice, hence the micrometer.
  for (const [first, ...others] of seams.values())
    for (const other of others) assert.ok(distance(first, other) < 2e-6, `a crack between ${first} and ${other}`);
  assert.ok([...seams.values()].some((positions) => positions.length > 1), 'no seam to look at');
}

await validate(readFileSync(join(folder, 'moved.glb')), 'moved.glb');

for (const name of ['georeferenced', 'local', 'textured', 'without_ground', 'no_manifold', 'empty']) {
  const path = join(folder, name);
  const plainBytes = readFileSync(join(path, 'map_plain.glb'));
  const dracoBytes = readFileSync(join(path, 'map.glb'));
  await validate(plainBytes, `${name}/map_plain.glb`);
  // Undecoded, the validator can only check the frame: it says that it does not know the extension.
  await validate(dracoBytes, `${name}/map.glb`, ['UNSUPPORTED_EXTENSION']);
  if (name === 'empty' || name === 'without_ground') {
    assert.ok(plainBytes.equals(dracoBytes), 'without triangles there is nothing to compress');
    continue;
  }
  if (name === 'textured') {
    const plain = await decode(plainBytes, 'textured/map_plain.glb');
    const pieces = nodeOf(plain, 'ground').getMesh().listPrimitives();
    assert.ok(pieces.length >= 6);
    const triangles = pieces.reduce((sum, piece) => sum + piece.getIndices().getCount() / 3, 0);
    for (const [file, bytes] of [['map_plain.glb', plainBytes], ['map.glb', dracoBytes]])
      await checkTexture(`textured/${file}`, bytes, triangles);
    await checkTiles(path, triangles, false);
    continue;
  }
  if (name === 'no_manifold') {
    await checkNoManifold(dracoBytes);
    continue;
  }
  const plain = await checkGround(name, plainBytes, dracoBytes);
  checkScene(plain, plainBytes, name === 'georeferenced');
  await checkTiles(path, groundOf(plain).getIndices().getCount() / 3, name === 'georeferenced');
}
console.log('all maps read');
