// One drive in, one map out, through the front door: simulates a short drive,
// starts the service, uploads with curl, waits for the map, checks what is
// served, and drives the viewer in Chromium.
//   node service_test.mjs PARKADE PARKADE_SIMULATE WORK_FOLDER
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

import { jobDone, json, putRig, run, startService, stopService, until, upload } from './service_process.mjs';

const [parkade, simulate, work] = process.argv.slice(2);
const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const at = (name) => path.join(work, name);

rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
run(simulate, 'lot', '--seed', '5', '--duration', '12', '--rate', '5', '--size', '480x300', '--gnss', 'rtk', '--out', at('drive.mcap'),
  '--rig-out', at('rig'), '--truth-out', at('truth'));

const { service, address } = await startService(parkade, at('data'));
let status;
try {
  putRig(address, 'car', at('rig'));

  writeFileSync(at('not_a_log.mcap'), 'this is a shopping list');
  const refused = await fetch(`${address}/api/v1/drives?filename=not_a_log.mcap`, { method: 'PUT', body: 'this is a shopping list' });
  assert.equal(refused.status, 400);
  assert.equal(refused.headers.get('content-type'), 'application/problem+json');

  const accepted = upload(address, at('drive.mcap'), 'filename=drive.mcap&site=yard&rig=car');
  const look = await until('the first look', 60, async () => {
    const answer = await fetch(`${address}/api/v1/drives/${accepted.drive.id}/inspect`);
    return answer.status === 200 && answer.json();
  });
  assert.equal(look.state, 'clean');
  assert.deepEqual(look.missing, []);
  await jobDone(address, accepted.job.id);
  assert.equal((await json(address, `/api/v1/drives/${accepted.drive.id}`)).state, 'ready');

  mkdirSync(at('served'));
  for (const name of ['map.glb', 'map_plain.glb', 'ground.ply', 'report.json'])
    run('curl', '-fsSL', '-o', at(`served/${name}`), `${address}/api/v1/sites/yard/maps/latest/${name}`);
  console.log(run('python3', path.join(root, 'scripts/check_map.py'), at('served')));

  // What the service published is a map for `parkade export` too.
  const version = await json(address, '/api/v1/sites/yard/maps/1');
  for (const { name, url } of version.files) {
    mkdirSync(path.dirname(at(`map/${name}`)), { recursive: true });
    run('curl', '-fsSL', '-o', at(`map/${name}`), `${address}${url}`);
  }
  const report = JSON.parse(readFileSync(at('map/report.json')));
  assert.equal(report.drives[0].log.sha256, createHash('sha256').update(readFileSync(at('drive.mcap'))).digest('hex'));

  // Made again from the same it is the same, and a comparison finds nothing.
  const again = await fetch(`${address}/api/v1/sites/yard/maps`, {
    method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ from: 1 }) });
  await jobDone(address, (await again.json()).id);
  const second = await json(address, '/api/v1/sites/yard/maps/2');
  // Timings are in the report.
  const hashes = (map) => Object.fromEntries(map.files.filter(({ name }) => name !== 'report.json').map(({ name, sha256 }) => [name, sha256]));
  assert.deepEqual(hashes(second), hashes(version));
  const comparison = await json(address, '/api/v1/sites/yard/compare?from=1&to=2');
  assert.ok(comparison.free_space.unchanged > 50, JSON.stringify(comparison.free_space));
  assert.deepEqual([comparison.regions, comparison.alignment.aligned_by], [[], 'drives']);
  const picture = await fetch(address + comparison.urls.png);
  assert.equal(picture.headers.get('content-type'), 'image/png');
  console.log(`compared: ${comparison.free_space.unchanged} m2 as before`);

  const formats = [...run(parkade, 'export', '--help').matchAll(/^  ([a-z0-9-]+) {2,}\S/gm)].map((match) => match[1]);
  assert.ok(formats.includes('pcd') && formats.includes('geotiff'), formats.join(' '));
  mkdirSync(at('exports'));
  for (const format of formats) {
    const out = at(`exports/${format === 'occupancy' ? 'grid.yaml' : format}`);
    run(parkade, 'export', at('map'), '--format', format, '--out', out);
    assert.ok(existsSync(out), format);
  }
  console.log(`exports: ${formats.join(', ')}`);
  const read = run('python3', path.join(root, 'tests/export/read_lanelet2.py'), at('map'), at('exports/lanelet2'));
  console.log(`lanelet2: ${read.trim()}`);

  if (existsSync(process.env.CHROMIUM ?? '/usr/bin/chromium'))
    // The whole page takes longer: target viewer_tests.
    console.log(run('node', path.join(root, 'web/e2e/run.mjs'), address, 'map', 'time', 'upload', 'review', 'shell', '--retries', '1'));
  else console.log('no Chromium here: the viewer was not driven');
} finally {
  status = await stopService(service);
}
assert.equal(status, 0);
