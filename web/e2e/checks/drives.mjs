// Drives, jobs and rigs.
import assert from 'node:assert/strict';

import { counted } from '../browser.mjs';

const kStages = 10; // of a job of one drive

/** Shows one job as another one: only what is given changes. */
async function pretend(page, job, changes) {
  await page.route(`**/api/v1/jobs/${job.id}`, async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, json: { ...(await response.json()), ...changes } });
  });
}

async function anyJob(world, state) {
  const { items } = await world.json('/api/v1/jobs');
  return items.find((job) => state === undefined || job.state === state) ?? world.skip(`no job is ${state ?? 'there'}`);
}

export const checks = {
  async 'drives are listed, found, and shown with what a first look found'(page, world) {
    const { address, drives, picture } = world;
    const drive = drives.find(({ inspection }) => ['clean', 'lossy', 'unusable'].includes(inspection)) ?? world.skip('no drive was looked at');
    await page.goto(`${address}/drives`);
    await page.waitForFunction((count) => document.querySelectorAll('[data-drive]').length === count, drives.length);
    await page.getByLabel('Search by name or site').fill('nothing is named like this');
    await page.getByText('No drive is like that').waitFor();
    await page.getByLabel('Search by name or site').fill(drive.name);
    await page.locator(`[data-drive="${drive.name}"] a`).first().click();
    await page.locator(`[data-inspection="${drive.inspection}"]`).waitFor();
    await page.getByRole('region', { name: 'Streams' }).waitFor();
    await picture('drive');
  },

  async 'a drive is deleted only by its name'(page, { address, drives }) {
    const [drive] = drives;
    let deleted = 0;
    await page.route(`**/api/v1/drives/${drive.id}`, (route) => {
      if (route.request().method() !== 'DELETE') return route.continue();
      deleted += 1;
      return route.fulfill({ status: 409, contentType: 'application/problem+json', body: '{"detail":"a job that runs uses it"}' });
    });
    await page.goto(`${address}/drives/${drive.id}`);
    await page.getByRole('button', { name: 'Delete', exact: true }).click();
    const button = page.getByRole('button', { name: 'Delete the drive' });
    assert.ok(await button.isDisabled());
    await page.getByRole('dialog').getByRole('textbox').fill(drive.name);
    await button.click();
    await page.getByRole('dialog').getByRole('alert').filter({ hasText: 'A job that runs uses it' }).waitFor();
    assert.equal(deleted, 1);
    page.faults.length = 0; // the browser notes the 409
  },

  async 'a job shows its stages and its log'(page, world) {
    const job = await anyJob(world, 'done');
    await page.goto(`${world.address}/jobs`);
    await page.locator(`[data-job="${job.id}"] a`).first().click();
    await page.waitForFunction((count) => document.querySelectorAll('[data-stage].done').length >= count, kStages);
    const log = page.getByLabel('Log of the job');
    await page.waitForFunction(() => document.querySelector('pre[data-following]')?.textContent.includes('stage='));
    await world.picture('job');
    const { isAtEnd, isLong } = await log.evaluate((view) => ({
      isAtEnd: view.scrollHeight - view.scrollTop - view.clientHeight < 30,
      isLong: view.scrollHeight > view.clientHeight + 100,
    }));
    assert.ok(isAtEnd, 'the log begins at its end');
    if (!isLong) return;
    await log.evaluate((view) => (view.scrollTop = 0));
    await page.locator('pre[data-following="false"]').waitFor();
    await page.getByRole('button', { name: 'To the end' }).click();
    await page.locator('pre[data-following="true"]').waitFor();
  },

  async 'a running job shows progress, and is cancelled'(page, world) {
    const job = await anyJob(world, 'done');
    await pretend(page, job, { state: 'running', stage: 'refine', progress: 0.42, eta_seconds: 75, finished_at: null });
    let isCancelled = false;
    await page.route(`**/api/v1/jobs/${job.id}/cancel`, (route) => {
      isCancelled = true;
      return route.fulfill({ status: 409, contentType: 'application/problem+json', body: '{"detail":"its map is being published"}' });
    });
    await page.goto(`${world.address}/jobs/${job.id}`);
    await page.getByText('Refine · 42 % · 1 min 15 s left').waitFor();
    await counted(page.locator('[data-stage="refine"].running'), 1);
    await counted(page.locator('[data-stage="write"].ahead'), 1);
    await page.getByRole('button', { name: 'Cancel' }).click();
    await page.getByRole('alert').filter({ hasText: 'Its map is being published' }).waitFor();
    assert.ok(isCancelled);
    page.faults.length = 0; // the browser notes the 409
  },

  async 'every failure is told in words, with the next step, and can be tried again'(page, world) {
    const job = await anyJob(world);
    const titles = new Set();
    for (const code of ['invalid_input', 'out_of_memory', 'crashed', 'time_limit', 'disk_full', 'internal', 'cancelled']) {
      await page.unrouteAll();
      await pretend(page, job, { state: code === 'cancelled' ? 'cancelled' : 'failed', stage: 'track', error_code: code, error: 'the reason of the service', map_version: null });
      await page.goto(`${world.address}/jobs/${job.id}`);
      const note = page.locator(`[data-failure="${code}"]`);
      await note.waitFor();
      titles.add(await note.getByRole('heading').textContent());
      if (code !== 'cancelled') await note.getByText('The reason of the service.').waitFor();
    }
    assert.equal(titles.size, 7);
    let isRetried = false;
    await page.route(`**/api/v1/jobs/${job.id}/retry`, (route) => {
      isRetried = true;
      return route.fulfill({ status: 202, contentType: 'application/json', body: JSON.stringify(job) });
    });
    const answered = page.waitForResponse((response) => response.url().endsWith('/retry'));
    await page.getByRole('button', { name: 'Try again' }).click();
    await answered;
    assert.ok(isRetried);
  },

  async 'the cameras of a rig are drawn on a car'(page, world) {
    const rig = (await world.json('/api/v1/rigs')).items[0] ?? world.skip('no rig is stored');
    await page.goto(`${world.address}/rigs`);
    await page.getByRole('link', { name: rig.name, exact: true }).click();
    await page.locator('canvas[data-drawn="true"]').waitFor({ timeout: 60_000 });
    await page.getByRole('region', { name: 'Cameras' }).locator('tbody tr').first().waitFor();
    await world.picture('rig');
  },

  async 'a rig that the service refuses is refused with its words'(page, { address }) {
    await page.goto(`${address}/rigs`);
    const form = page.getByRole('form', { name: 'Add a rig' });
    await form.locator('input[name="rig"]').fill('a bad name');
    await form.getByRole('button', { name: 'Add the rig' }).click();
    await form.getByRole('alert').filter({ hasText: 'letters, digits' }).waitFor();
    await form.locator('input[name="rig"]').fill('e2e-bad-rig');
    await form.locator('input[name="files"]').setInputFiles({ name: 'camchain-imucam.yaml', mimeType: 'text/yaml', buffer: Buffer.from('cam0: {}\n') });
    await form.getByRole('button', { name: 'Add the rig' }).click();
    await form.getByRole('alert').filter({ hasText: /lacks|cam0|imu0/ }).waitFor();
    assert.equal((await page.request.get(`${address}/api/v1/rigs/e2e-bad-rig`)).status(), 404);
    page.faults.length = 0; // the browser notes the 400
  },
};
