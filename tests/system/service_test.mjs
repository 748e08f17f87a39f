// One drive in, one map out, through the front door: simulates a short drive,
// starts the service, uploads with curl, waits for the map, checks what is
// served, and drives the viewer in Chromium.
//   node service_test.mjs PARKADE PARKADE_SIMULATE WORK_FOLDER
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const [parkade, simulate, work] = process.argv.slice(2);
const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const at = (name) => path.join(work, name);
const run = (program, ...args) => execFileSync(program, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });

async function until(what, seconds, probe) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; ) {
    const found = await probe();
    if (found) return found;
    await new Promise((resolve) => setTimeout(resolve, 200));
  }
  throw new Error(`${what}: not within ${seconds} s`);
}

async function startService() {
  const service = spawn(parkade, ['serve', '--data', at('data'), '--listen', '127.0.0.1:0'], { stdio: ['ignore', 'ignore', 'pipe'] });
  let log = '';
  service.stderr.on('data', (text) => (log += text));
  const address = await until('the service listens', 10, () => {
    assert.equal(service.exitCode, null, log);
    return /listening on (http:\/\/[\d.:]+)/.exec(log)?.[1];
  });
  return { service, address };
}

async function json(address, route) {
  const response = await fetch(address + route);
  assert.equal(response.status, 200, `${route}: ${response.status}`);
  return response.json();
}

async function jobDone(address, id) {
  const job = await until('the job ends', 400, async () => {
    const found = await json(address, `/api/v1/jobs/${id}`);
    return ['done', 'failed', 'cancelled'].includes(found.state) && found;
  });
  assert.equal(job.state, 'done', job.error);
}

rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
run(simulate, 'lot', '--seed', '5', '--duration', '12', '--rate', '5', '--size', '480x300', '--gnss', 'rtk', '--out', at('drive.mcap'),
  '--rig-out', at('rig'), '--truth-out', at('truth'));

const { service, address } = await startService();
try {
  const parts = readdirSync(at('rig')).flatMap((name) => ['-F', `${name}=@${at('rig')}/${name}`]);
  run('curl', '-fsS', '-X', 'PUT', `${address}/api/v1/rigs/car`, ...parts);

  writeFileSync(at('not_a_log.mcap'), 'this is a shopping list');
  const refused = await fetch(`${address}/api/v1/drives?filename=not_a_log.mcap`, { method: 'PUT', body: 'this is a shopping list' });
  assert.equal(refused.status, 400);
  assert.equal(refused.headers.get('content-type'), 'application/problem+json');

  const accepted = JSON.parse(run('curl', '-fsS', '-T', at('drive.mcap'), `${address}/api/v1/drives?filename=drive.mcap&site=yard&rig=car`));
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
    console.log(run('node', path.join(root, 'web/browser_test.mjs'), `${address}/`, at('viewer.png')));
  else console.log('no Chromium here: the viewer was not driven');
} finally {
  service.kill('SIGTERM');
  await until('the service stops', 20, () => service.exitCode !== null);
}
assert.equal(service.exitCode, 0);
