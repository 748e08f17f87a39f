// Uploads: what is no log is refused with words, and what broke off goes on.
import assert from 'node:assert/strict';
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';

const kBytes = 16 << 20; // several times what the buffers of a connection hold

/** A file that is there for one check. */
async function withFile(name, content, check) {
  const folder = await mkdtemp(path.join(tmpdir(), 'parkade-upload-'));
  try {
    const file = path.join(folder, name);
    await writeFile(file, content);
    await check(file);
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

/** Bytes that repeat in no pattern that a line would compress. */
function noise(count) {
  const bytes = Buffer.alloc(count);
  let state = 12345;
  for (let i = 0; i < count; ++i) {
    state = (Math.imul(state, 1103515245) + 12345) >>> 0;
    bytes[i] = state >>> 24;
  }
  return bytes;
}

const choose = (page, file) => page.locator('input[data-input="files"]').setInputFiles(file);
/** Uploads as fast as a slow line: an upload of this size is caught midway. Returns what cuts the line: else all that waits goes out when the page closes. */
async function slowDown(page, bytesPerSecond) {
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  const setLine = (offline) =>
    session.send('Network.emulateNetworkConditions', { offline, latency: 0, downloadThroughput: -1, uploadThroughput: bytesPerSecond });
  await setLine(false);
  return () => setLine(true);
}

/** Drops files on the page, as a file manager does: the same bytes and times whenever it is called. */
const drop = (page, names, bytes) =>
  page.getByRole('group', { name: 'Drop drives here' }).evaluate(
    (zone, { names, bytes }) => {
      const dataTransfer = new DataTransfer();
      for (const name of names) dataTransfer.items.add(new File([new Uint8Array(bytes).map((_, i) => (i * i) >> 5)], name, { lastModified: 1e12 }));
      zone.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
    },
    { names, bytes },
  );

/** From now on the service gets nothing of what is sent, so that no drive comes of it and no job begins; the page is told that all arrived. */
async function swallowRest(page) {
  page.swallowed = 0;
  await page.route('**/api/v1/uploads/*', (route) => {
    if (route.request().method() !== 'PATCH') return route.continue();
    page.swallowed += 1;
    const offset = Number(route.request().headers()['upload-offset']) + (route.request().postDataBuffer()?.length ?? 0);
    return route.fulfill({ status: 204, headers: { 'tus-resumable': '1.0.0', 'upload-offset': String(offset) } });
  });
}

/** Answers for a set as if it had ended so. */
async function endAs(route, end) {
  if (route.request().method() !== 'GET') return route.continue();
  const response = await route.fetch();
  return route.fulfill({ response, json: { ...(await response.json()), error: null, ...end } });
}

export const checks = {
  async 'a file that is no log is left out before anything is sent'(page, { address, picture }) {
    await page.goto(`${address}/upload`);
    await choose(page, [
      { name: 'notes.txt', mimeType: 'text/plain', buffer: Buffer.from('hello') },
      { name: 'empty.bag', mimeType: 'application/octet-stream', buffer: Buffer.alloc(0) },
    ]);
    const note = page.getByRole('alert').filter({ hasText: '2 files were left out' });
    await note.getByText('no drive log').waitFor();
    await note.getByText('it is empty').waitFor();
    assert.equal(await page.locator('[data-upload]').count(), 0);
    await picture('upload_left_out');
  },

  async 'what only looks like a log is refused by the service, in words'(page, { address, drives, picture }) {
    await page.goto(`${address}/upload`);
    await choose(page, { name: 'e2e-broken.mcap', mimeType: 'application/octet-stream', buffer: Buffer.from('this is no recording at all') });
    const form = page.getByRole('form', { name: 'Where these drives belong' });
    await form.getByLabel('Site').fill('not a name');
    await form.getByRole('button', { name: 'Upload this drive' }).click();
    await page.getByRole('alert').filter({ hasText: 'letters, digits' }).waitFor();
    await form.getByLabel('Site').fill('e2e-broken');
    await form.getByRole('button', { name: 'Upload this drive' }).click();
    const card = page.locator('[data-upload="e2e-broken.mcap"][data-state="failed"]');
    await card.waitFor({ timeout: 30_000 });
    const words = await card.getByRole('alert').textContent();
    assert.ok(words.trim().length > 20 && !/the service answered/i.test(words), words);
    await picture('upload_refused');
    await card.getByRole('button', { name: 'Remove' }).click();
    await page.waitForFunction(() => !document.querySelector('[data-upload]'));
    assert.equal((await (await page.request.get(`${address}/api/v1/drives`)).json()).items.length, drives.length);
    page.faults.length = 0; // the browser notes the refusal
  },

  async 'an upload that a closed page cut off goes on in the next one'(page, { address }) {
    await withFile('e2e-cut.mcap', noise(kBytes), async (file) => {
      const first = await page.context().newPage();
      await first.goto(`${address}/upload`);
      const cutLine = await slowDown(first, 800_000);
      await choose(first, file);
      await first.getByRole('button', { name: 'Upload this drive' }).click();
      await first.locator('[data-upload][data-state="sending"]').waitFor();
      // Asked from here: the page's policy lets no text become code while it waits by itself.
      while ((await first.locator('[data-upload] progress').evaluate((bar) => bar.value)) < 0.1) await first.waitForTimeout(50);
      await cutLine();
      await first.close();

      await page.goto(`${address}/upload`);
      await page.locator('[data-unfinished="e2e-cut.mcap"]').waitFor({ timeout: 30_000 });
      await slowDown(page, 400_000);
      await choose(page, file);
      const wentOn = page.locator('[data-upload="e2e-cut.mcap"] [data-went-on]');
      await wentOn.waitFor({ timeout: 30_000 });
      const at = Number(await wentOn.getAttribute('data-went-on'));
      assert.ok(at > 0.05 * kBytes && at < kBytes, `it went on at ${at} of ${kBytes}`);
      await page.getByRole('button', { name: 'Pause' }).click();
      await page.locator('[data-upload][data-state="paused"]').waitFor();
      const deleted = page.waitForResponse((response) => response.request().method() === 'DELETE');
      await page.getByRole('button', { name: 'Cancel' }).click();
      assert.equal((await deleted).status(), 204);
      await page.reload();
      await page.getByText('Drop drive logs or folders here').waitFor();
      assert.equal(await page.evaluate(() => Object.keys(localStorage).filter((key) => key.startsWith('tus::')).length), 0, 'nothing of it stays');
    });
  },

  async 'the parts of a split recording become one set, which is forgotten when it is cancelled'(page, { address }) {
    await page.goto(`${address}/upload`);
    await slowDown(page, 200_000);
    const part = (i) => ({ name: `e2e-tour_${i}.bag`, mimeType: 'application/octet-stream', buffer: noise(300_000) });
    await choose(page, [part(1), part(0)]);
    await page.getByText('2 files,').waitFor();
    const declared = page.waitForResponse((response) => response.url().endsWith('/upload-sets') && response.request().method() === 'POST');
    await page.getByRole('button', { name: 'Upload this drive' }).click();
    const set = await (await declared).json();
    assert.deepEqual(set.parts.map((one) => one.path), ['e2e-tour_0.bag', 'e2e-tour_1.bag']);
    const deleted = page.waitForResponse((response) => response.request().method() === 'DELETE');
    await page.getByRole('button', { name: 'Cancel' }).click();
    assert.equal((await deleted).status(), 204);
    assert.equal((await page.request.get(`${address}/api/v1/upload-sets/${set.id}`)).status(), 404);
  },

  async 'a set that the service can make no log of is refused in its words'(page, { address }) {
    await page.goto(`${address}/upload`);
    const declared = page.waitForResponse((response) => response.url().endsWith('/upload-sets') && response.request().method() === 'POST');
    await swallowRest(page);
    await drop(page, ['e2e-torn_0.bag', 'e2e-torn_1.bag'], 50_000);
    await page.getByText('2 files,').waitFor();
    await page.route('**/api/v1/upload-sets/*', (route) => endAs(route, { state: 'refused', error: "'e2e-torn_1.bag' is no ROS bag" }));
    await page.getByRole('button', { name: 'Upload this drive' }).click();
    const { id } = await (await declared).json();
    const card = page.locator('[data-upload^="e2e-torn"][data-state="failed"]');
    await card.getByRole('alert').filter({ hasText: "'e2e-torn_1.bag' is no ROS bag" }).waitFor();
    await card.getByRole('button', { name: 'Remove' }).click();
    await page.waitForFunction(() => !document.querySelector('[data-upload]'));
    await page.request.delete(`${address}/api/v1/upload-sets/${id}`);
  },

  async 'a set that a reload cut off goes on where it was, and ends as a drive'(page, { address, drives, skip, picture }) {
    if (drives.length === 0) skip('no drive to end as');
    const names = ['e2e-trip_0.bag', 'e2e-trip_1.bag'];
    await page.goto(`${address}/upload`);
    await slowDown(page, 300_000);
    await drop(page, names, 1_000_000);
    const declared = page.waitForResponse((response) => response.url().endsWith('/upload-sets') && response.request().method() === 'POST');
    await page.getByRole('button', { name: 'Upload this drive' }).click();
    const set = await (await declared).json();
    while ((await page.locator('[data-upload] progress').evaluate((bar) => bar.value)) < 0.2) await page.waitForTimeout(50);
    await page.reload();
    await page.locator('[data-unfinished^="e2e-trip"]').waitFor({ timeout: 30_000 });
    await picture('upload_unfinished_set');

    await swallowRest(page);
    await page.route(`**/api/v1/upload-sets/${set.id}`, (route) => (page.swallowed > 0 ? endAs(route, { state: 'done', drive: drives[0].id, job: 'a-job' }) : route.continue()));
    await drop(page, names, 1_000_000);
    const card = page.locator('[data-upload^="e2e-trip"]');
    await card.locator('[data-went-on]').waitFor({ timeout: 30_000 });
    const at = Number(await card.locator('[data-went-on]').getAttribute('data-went-on'));
    assert.ok(at > 100_000 && at < 2_000_000, `it went on at ${at} of 2000000`);
    await page.locator('[data-upload^="e2e-trip"][data-state="done"]').waitFor({ timeout: 60_000 });
    assert.equal(await card.getByRole('link', { name: 'Follow the job' }).getAttribute('href'), '/jobs/a-job');
    await card.getByRole('button', { name: 'Clear' }).click();
    assert.equal(await page.evaluate(() => Object.keys(localStorage).filter((key) => /upload-set|^tus::/.test(key)).length), 0, 'nothing of it stays');
    await page.request.delete(`${address}/api/v1/upload-sets/${set.id}`);
  },
};
