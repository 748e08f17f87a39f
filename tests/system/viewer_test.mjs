// The viewer with places that have what a short drive lacks: loops, links between drives, several decks, versions
// that differ. Simulates and maps them (for some minutes; kept in WORK for the next run), then drives the page in
// Chromium and measures its budget.
//   node viewer_test.mjs PARKADE PARKADE_SIMULATE WORK [--pictures FOLDER] [NAME OF A CHECK ...]
import { existsSync, mkdirSync, renameSync } from 'node:fs';
import path from 'node:path';
import { spawnSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';

import { jobDone, json, putRig, run, startService, stopService, upload } from './service_process.mjs';

const [parkade, simulate, work, ...rest] = process.argv.slice(2);
const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const at = (name) => path.join(work, name);
mkdirSync(work, { recursive: true });

/** Site, and what the simulator is told of each of its drives. */
const kDrives = [
  ['lot', 'lot', '--seed', '12', '--day', '0', '--length', '170', '--speed-bumps', '1'],
  ['lot', 'lot', '--seed', '12', '--day', '1', '--length', '120'],
  ['garage', 'garage', '--seed', '31', '--day', '0', '--duration', '60'],
];

const { service, address } = await startService(parkade, at('data'));
let status = 1;
try {
  const known = (await json(address, '/api/v1/drives')).items.map(({ name }) => name);
  for (const [i, [site, ...scene]] of kDrives.entries()) {
    const name = `${site}_${i}`;
    if (known.includes(name)) continue;
    if (!existsSync(at(`${name}.mcap`))) {
      run(simulate, ...scene, '--rate', '5', '--size', '480x300', '--gnss', 'rtk', '--quiet', '--out', at(`new_${name}.mcap`),
        '--rig-out', at(`${name}_rig`), '--truth-out', at(`${name}_truth`));
      renameSync(at(`new_${name}.mcap`), at(`${name}.mcap`));
    }
    putRig(address, `car_${i}`, at(`${name}_rig`));
    const { job } = upload(address, at(`${name}.mcap`), `filename=${name}.mcap&site=${site}&rig=car_${i}`);
    await jobDone(address, job.id, 1200);
    console.log(`mapped ${name}`);
  }
  const of = (script, ...args) => spawnSync('node', [path.join(root, 'web/e2e', script), address, ...args], { stdio: 'inherit' }).status;
  status = of('run.mjs', ...rest) || of('budget.mjs') || of('whole_review.mjs', 'lot');
} finally {
  await stopService(service);
}
process.exit(status);
