// The reference client of tus against the service: whole uploads, aborted ones, a set of parts that
// are sent at the same time, and a service that is killed in between, as often as wanted.
//   node tus_client_test.mjs PARKADE_SERVE_PROGRAM WORK_FOLDER [MIB] [KILLS]
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { createReadStream, createWriteStream, mkdirSync, readdirSync, rmSync, statSync } from 'node:fs';
import { once } from 'node:events';
import net from 'node:net';
import path from 'node:path';
import * as tus from 'tus-js-client';

const [program, work, mebibytes = '24', kills = '6'] = process.argv.slice(2);
const part = 4 << 20;
const log = path.join(work, 'drive.bag');
const data = path.join(work, 'data');

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

async function until(what, probe, seconds = 60) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; await pause(20)) {
    const found = await probe();
    if (found) return found;
  }
  throw new Error(`${what}: not within ${seconds} s`);
}

async function freePort() {
  const server = net.createServer().listen(0, '127.0.0.1');
  await once(server, 'listening');
  const { port } = server.address();
  server.close();
  await once(server, 'close');
  return port;
}

/** Bytes that repeat nowhere, the same at every run. */
async function writeLog() {
  const out = createWriteStream(log);
  const hash = createHash('sha256');
  for (let i = 0; i < Number(mebibytes); ++i) {
    const piece = Buffer.alloc(1 << 20);
    for (let at = 0, x = i * 2654435761 + 1; at < piece.length; at += 4) {
      x = (Math.imul(x, 1664525) + 1013904223) >>> 0;
      piece.writeUInt32LE(x, at);
    }
    if (i === 0) piece.write('log ok\n');
    hash.update(piece);
    if (!out.write(piece)) await once(out, 'drain');
  }
  out.end();
  await once(out, 'finish');
  return hash.digest('hex');
}

const port = await freePort();
const address = `http://127.0.0.1:${port}`;
let service;
async function start() {
  service = spawn(program, ['serve', data], { stdio: 'ignore', env: { ...process.env, LISTEN: `127.0.0.1:${port}` } });
  await until('the service answers', async () => (await fetch(`${address}/healthz`).catch(() => null))?.ok);
}
async function end(signal) {
  service.kill(signal);
  await once(service, 'exit');
}

/** Uploads one part of a set: the bytes of the log from `begin` on, `bytes` of them. */
function uploadPart({ upload: address_of, bytes }, begin, onProgress) {
  return new Promise((resolve, reject) => {
    new tus.Upload(createReadStream(log, { start: begin, end: begin + bytes - 1 }), {
      uploadUrl: `${address}${address_of}`,
      chunkSize: 1 << 20,
      uploadSize: bytes,
      retryDelays: Array(100).fill(100),
      onProgress,
      onError: reject,
      onSuccess: resolve,
    }).start();
  });
}

async function hashOf(file, options) {
  const hash = createHash('sha256');
  for await (const piece of createReadStream(file, options)) hash.update(piece);
  return hash.digest('hex');
}

/** The log as a split recording, whose service is killed between and after its parts. */
async function sendSplitLog() {
  const third = Math.floor(length / 3);
  const begins = [0, third, 2 * third];
  const parts = await Promise.all(begins.map(async (begin, i) => {
    const bytes = (begins[i + 1] ?? length) - begin;
    return { path: `log ok/drive_${i}.bag`, bytes, sha256: await hashOf(log, { start: begin, end: begin + bytes - 1 }) };
  }));
  const body = JSON.stringify({ filename: 'split', site: 'yard', parts });
  const declared = await fetch(`${address}/api/v1/upload-sets`, { method: 'POST', body });
  assert.equal(declared.status, 201);
  const set = await declared.json();
  let sent = 0;
  const sending = Promise.all(set.parts.map((one, i) => uploadPart(one, begins[i], (bytes) => (sent = Math.max(sent, bytes)))));
  await until('a part is half there', () => sent > third / 2);
  await end('SIGKILL');
  await start();
  await sending;
  await end('SIGKILL'); // perhaps while it is put together
  await start();
  const done = await until('the set is one drive', async () => {
    const now = await (await fetch(`${address}/api/v1/upload-sets/${set.id}`)).json();
    assert.notEqual(now.state, 'refused', now.error);
    return now.state === 'done' && now;
  });
  const drives = (await (await fetch(`${address}/api/v1/drives?limit=200`)).json()).items;
  assert.deepEqual(drives.filter((one) => one.filename === 'split').map((one) => one.id), [done.drive]);
  const { sha256: hash } = drives.find((one) => one.id === done.drive);
  const tar = path.join(data, 'logs', hash.slice(0, 2), hash);
  assert.equal(await hashOf(tar), hash);
  assert.deepEqual(
    execFileSync('tar', ['-tf', tar]).toString().trim().split('\n'), parts.map((one) => one.path));
  for (const one of parts) {
    const content = execFileSync('tar', ['-xOf', tar, one.path], { maxBuffer: 2 * length });
    assert.equal(createHash('sha256').update(content).digest('hex'), one.sha256);
  }
  await until('no part is left', () => readdirSync(path.join(data, 'uploads')).length === 0);
}

/** Uploads the log; `also` is called with the upload when it has begun. */
function upload(options = {}, also = () => {}) {
  return new Promise((resolve, reject) => {
    const one = new tus.Upload(createReadStream(log), {
      endpoint: `${address}/api/v1/uploads`,
      chunkSize: part,
      uploadSize: statSync(log).size,
      metadata: { filename: 'drive.bag', site: 'yard' },
      retryDelays: Array(100).fill(100),
      onError: reject,
      onSuccess: ({ lastResponse }) => resolve({ upload: one, response: lastResponse }),
      ...options,
    });
    one.start();
    also(one);
  });
}

const logs = () => readdirSync(path.join(data, 'logs'), { recursive: true }).filter((name) => name.length > 60);

rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
const sha256 = await writeLog();
const length = statSync(log).size;
await start();
try {
  // From the first byte to the drive.
  const { upload: done, response } = await upload({ uploadDataDuringCreation: true });
  const drive = await (await fetch(`${address}/api/v1/drives/${response.getHeader('Upload-Drive')}`)).json();
  assert.equal(drive.sha256, sha256);
  assert.equal(drive.filename, 'drive.bag');
  assert.equal(drive.site, 'yard');
  assert.equal((await fetch(`${address}/api/v1/jobs/${response.getHeader('Upload-Job')}`)).status, 200);
  const asJson = await (await fetch(done.url)).json();
  assert.equal(asJson.state, 'done');
  assert.equal(asJson.drive, drive.id);

  // Through a proxy that knows no PATCH; equal logs are stored once.
  await upload({ overridePatchMethod: true });
  assert.equal(logs().length, 1);

  // Aborted, and gone on with by another client that only knows the address.
  const address_of = await new Promise((resolve, reject) => {
    upload({
      onError: reject,
      onChunkComplete(_, accepted) {
        if (accepted < 2 * part) return;
        this.one.abort().then(() => resolve(this.one.url));
      },
    }, (one) => (one.options.one = one)).catch(reject);
  });
  const resumed = await upload({ uploadUrl: address_of, endpoint: undefined });
  assert.ok(resumed.response.getHeader('Upload-Drive'));

  // Terminated: nothing is left.
  await new Promise((resolve, reject) => {
    upload({
      onError: reject,
      onChunkComplete() {
        this.one.abort(true).then(resolve, reject);
      },
    }, (one) => (one.options.one = one)).catch(reject);
  });
  assert.deepEqual(readdirSync(path.join(data, 'uploads')), []);

  // Three files of one drive at the same time.
  await sendSplitLog();

  // Killed at any time: what was said to be there is there, so at most a part is sent again.
  let accepted = 0, sent = 0, restarts = 0;
  const survivor = upload({
    onProgress: (bytes) => (sent = Math.max(sent, bytes)),
    onChunkComplete: (_, bytes) => (accepted = bytes),
    onAfterResponse(request, answer) {
      if (request.getMethod() !== 'HEAD') return;
      const offset = Number(answer.getHeader('Upload-Offset'));
      assert.ok(offset >= accepted, `${accepted} bytes were acknowledged, ${offset} are there`);
    },
  });
  let over = false;
  survivor.then(() => (over = true), () => (over = true));
  const step = length / (Number(kills) + 1);
  for (let i = 1; i <= Number(kills) && !over; ++i) {
    await until('the upload goes on', () => over || sent >= i * step * 0.98, 600);
    await pause(Math.random() * 30);
    await end('SIGKILL');
    ++restarts;
    await start();
  }
  const last = (await survivor).response.getHeader('Upload-Drive');
  assert.equal((await (await fetch(`${address}/api/v1/drives/${last}`)).json()).sha256, sha256);
  console.log(`${restarts} kills, ${mebibytes} MiB: hash equal`);
} finally {
  await end('SIGTERM');
  rmSync(work, { recursive: true, force: true });
}
