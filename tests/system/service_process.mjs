// The service as a process of its own, for tests that use it as people and browsers do.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { readdirSync } from 'node:fs';

/** What a program prints; its complaints go to ours. */
export const run = (program, ...args) => execFileSync(program, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });

/** What `probe` finds, once it finds something. */
export async function until(what, seconds, probe) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; ) {
    const found = await probe();
    if (found) return found;
    await new Promise((resolve) => setTimeout(resolve, 200));
  }
  throw new Error(`${what}: not within ${seconds} s`);
}

/** Starts a service on a free port of loopback, with what else is said on its command line. */
export async function startService(parkade, data, ...options) {
  const service = spawn(parkade, ['serve', '--data', data, '--listen', '127.0.0.1:0', ...options], { stdio: ['ignore', 'ignore', 'pipe'] });
  let log = '';
  service.stderr.on('data', (text) => (log += text));
  const address = await until('the service listens', 30, () => {
    assert.equal(service.exitCode, null, log);
    return /listening on (http:\/\/[\d.:]+)/.exec(log)?.[1];
  });
  return { service, address };
}

/** Ends a service as systemd does, and says whether it took that well. */
export async function stopService(service) {
  service.kill('SIGTERM');
  await until('the service stops', 20, () => service.exitCode !== null);
  return service.exitCode;
}

export async function json(address, route) {
  const response = await fetch(address + route);
  assert.equal(response.status, 200, `${route}: ${response.status}`);
  return response.json();
}

export async function jobDone(address, id, seconds = 400) {
  const job = await until('the job ends', seconds, async () => {
    const found = await json(address, `/api/v1/jobs/${id}`);
    return ['done', 'failed', 'cancelled'].includes(found.state) && found;
  });
  assert.equal(job.state, 'done', job.error);
}

/** Stores the rig of a folder. */
export function putRig(address, name, folder) {
  const parts = readdirSync(folder).flatMap((file) => ['-F', `${file}=@${folder}/${file}`]);
  run('curl', '-fsS', '-X', 'PUT', `${address}/api/v1/rigs/${name}`, ...parts);
}

/** Uploads a log. Returns the drive and its job. */
export const upload = (address, log, query) => JSON.parse(run('curl', '-fsS', '-T', log, `${address}/api/v1/drives?${query}`));
