// The review of a version: comments, checklist, decisions, and what awaits.
import assert from 'node:assert/strict';

import { counted, mapShown } from '../browser.mjs';
import { clickGround, groundPoint, viewOfGround } from '../ground.mjs';

const pathOf = ({ name, latest_version: version }) => `/sites/${name}/maps/${version}`;

async function openReview(page, world) {
  const { address, site } = world;
  await page.goto(`${address}${pathOf(site)}?tab=review&view=${await viewOfGround(world)}`);
  await mapShown(page, `${site.name}/${site.latest_version}`);
  await page.getByRole('region', { name: 'Comments' }).waitFor();
}

const post = (address, route, body) =>
  fetch(`${address}/api/v1${route}`, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) }).then((response) => response.json());

export const checks = {
  async 'a comment at a place: written, answered, changed, resolved, deleted'(page, world) {
    const text = `The edge is frayed ${Date.now()}`;
    const route = `/api/v1${pathOf(world.site)}/comments`;
    try {
      await openReview(page, world);
      await page.getByRole('button', { name: 'At a place in the map' }).click();
      const field = page.getByLabel('Comment', { exact: true });
      await clickGround(page, () => field.isVisible());
      assert.ok(await page.getByRole('radio', { name: /^The place at/ }).isChecked());
      await page.getByRole('button', { name: 'Comment', exact: true }).click();
      await page.getByRole('alert').getByText('Write what there is to say first').waitFor();
      await field.fill(text);
      await page.getByRole('button', { name: 'Comment', exact: true }).click();

      const thread = page.locator(`#${await page.getByRole('article').filter({ hasText: text }).getAttribute('id')}`);
      await thread.getByText(/^at -?[\d.]+, /).waitFor();
      await thread.locator('.head[aria-pressed="true"]').waitFor(); // what was written is chosen
      await thread.getByLabel('Answer', { exact: true }).last().fill('It was cut since');
      await thread.getByRole('button', { name: 'Answer' }).click();
      await thread.locator('.answer').getByText('It was cut since').waitFor();
      await world.picture('review');

      await thread.getByRole('button', { name: 'Edit' }).first().click();
      await thread.getByLabel('Comment', { exact: true }).fill(`${text}, in the north`);
      await thread.getByRole('button', { name: 'Save' }).click();
      await thread.getByText(`${text}, in the north`).waitFor();
      await thread.getByRole('button', { name: 'Resolve' }).click();
      await thread.getByText('resolved', { exact: true }).waitFor();
      await thread.getByRole('button', { name: 'Reopen' }).click();
      await thread.getByText('resolved', { exact: true }).waitFor({ state: 'detached' });

      for (const left of [1, 0]) {
        await thread.getByRole('button', { name: 'Delete' }).last().click();
        await page.getByRole('dialog').getByRole('button', { name: 'Delete', exact: true }).click();
        if (left > 0) await thread.locator('.answer').waitFor({ state: 'detached' });
        else await thread.waitFor({ state: 'detached' });
      }
    } finally {
      // What a failure left would lie over the marker of the next check.
      const { items } = await world.json(route);
      const first = items.find((comment) => comment.text.startsWith(text));
      const left = first ? [...items.filter(({ thread }) => thread === first.id), first] : [];
      for (const { id } of left) await fetch(`${world.address}${route}/${id}`, { method: 'DELETE' });
    }
  },

  async 'comments of others come by themselves; keys step through them; an address leads to one'(page, world) {
    const { address, site } = world;
    const route = `${pathOf(site)}/comments`;
    await openReview(page, world);
    const stamp = Date.now();
    const made = [];
    try {
      const middle = await groundPoint(world);
      made.push(await post(address, route, { text: `first ${stamp}`, pin: { point: middle } }));
      made.push(await post(address, route, { text: `second ${stamp}`, pin: null }));
      const [first, second] = made.map(({ text }) => page.getByRole('article').filter({ hasText: text }));
      await second.waitFor();
      await first.waitFor();
      await page.keyboard.press('j'); // the newest is on top
      await page.waitForFunction((id) => document.querySelector(`#thread-${id} .head`)?.getAttribute('aria-pressed') === 'true', made[1].id);
      await page.keyboard.press('j');
      await page.waitForFunction((id) => document.querySelector(`#thread-${id} .head`)?.getAttribute('aria-pressed') === 'true', made[0].id);
      assert.equal(new URL(page.url()).searchParams.get('comment'), made[0].id);

      await page.keyboard.press('k');
      await page.waitForFunction((id) => document.querySelector(`#thread-${id} .head`)?.getAttribute('aria-pressed') === 'true', made[1].id);
      await page.goto(`${address}/review`);
      await page.getByRole('link', { name: new RegExp(`first ${stamp}`) }).click();
      await page.waitForFunction((id) => document.querySelector(`#thread-${id} .head`)?.getAttribute('aria-pressed') === 'true', made[0].id, { timeout: 60_000 });

      // It lies in the middle of the picture now: its marker is there to be clicked.
      await mapShown(page, `${site.name}/${site.latest_version}`);
      await page.keyboard.press('Escape');
      await page.waitForFunction((id) => document.querySelector(`#thread-${id} .head`)?.getAttribute('aria-pressed') === 'false', made[0].id);
      const { width, height } = await page.locator('#canvas').boundingBox();
      await page.locator('#canvas').click({ position: { x: width / 2, y: height / 2 - 12 } });
      await page.waitForFunction((id) => document.querySelector(`#thread-${id} .head`)?.getAttribute('aria-pressed') === 'true', made[0].id);
    } finally {
      for (const { id } of made) await fetch(`${address}/api/v1${route}/${id}`, { method: 'DELETE' });
    }
  },

  async 'ticks are kept for all reviewers, and shown where somebody decides'(page, world) {
    const { address, site } = world;
    const route = `/api/v1${pathOf(site)}/checklist`;
    const tick = (id, ticked) =>
      fetch(`${address}${route}/${id}`, { method: 'PUT', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ ticked }) });
    const { items } = await world.json(route);
    const decided = [];
    await page.route('**/review', (asked) => {
      if (asked.request().method() !== 'POST') return asked.continue();
      decided.push(asked.request().postDataJSON());
      return asked.fulfill({ json: {} });
    });
    // As it is while it is reviewed, whatever this service's version is.
    const before = { action: 'reject', from: 'in_review', to: 'rejected', comment: 'A gap', author: 'ann', created_at: '2026-01-01T00:00:00Z',
      checklist: [{ id: 'ramp', text: 'Ramps driven', ticked_by: 'ann', ticked_at: '2026-01-01T00:00:00Z' }, { id: 'bay', text: 'Bays named', ticked_by: null, ticked_at: null }] };
    await page.route('**/review?*', async (asked) => {
      const response = await asked.fetch();
      return asked.fulfill({ response, json: { ...(await response.json()), state: 'in_review', history: [before], next_cursor: null } });
    });
    try {
      for (const { id } of items) await tick(id, false);
      await openReview(page, world);
      const list = page.getByRole('region', { name: 'Checklist' });
      await list.getByRole('checkbox').first().check();
      await list.getByText(`1 of ${items.length} ticked`).waitFor();
      await list.locator('.by').waitFor(); // by whom
      await page.reload();
      await list.getByText(`1 of ${items.length} ticked`).waitFor();
      await tick(items[0].id, false); // somebody else
      await list.getByText(`0 of ${items.length} ticked`).waitFor();
      assert.equal(await list.getByRole('checkbox').first().isChecked(), false);
      await page.route(`**/checklist/${items[0].id}`, (asked) => asked.fulfill({ status: 503, contentType: 'application/problem+json', json: { title: 'Full', status: 503, detail: 'the disk is full' } }));
      await list.getByRole('checkbox').first().click();
      await page.getByRole('alert').getByText('The tick was not kept: the disk is full').waitFor();
      assert.equal(await list.getByRole('checkbox').first().isChecked(), false, 'what was not kept is not shown');
      page.faults = page.faults.filter((fault) => !fault.includes('503'));

      await page.getByRole('button', { name: 'Reject' }).click();
      const dialog = page.getByRole('dialog');
      await dialog.getByRole('button', { name: 'Reject' }).click();
      await dialog.getByRole('alert').getByText('Say why it is rejected').waitFor();
      assert.equal(decided.length, 0);
      await dialog.getByRole('textbox', { name: /^Reason/ }).fill('The ramp is missing');
      await dialog.getByRole('button', { name: 'Reject' }).click();
      await dialog.waitFor({ state: 'detached' });
      assert.deepEqual(decided, [{ action: 'reject', from: 'in_review', comment: 'The ramp is missing' }]);

      await page.keyboard.press('A');
      await dialog.getByText('Approve this version?').waitFor();
      await dialog.getByText('Not ticked in the checklist:').waitFor();
      await counted(dialog.getByRole('note').getByRole('listitem'), items.length);
      await world.picture('approve');
      await page.keyboard.press('Escape');
      await dialog.waitFor({ state: 'detached' });
      await page.locator('summary').filter({ hasText: 'History' }).click();
      await page.getByText('Checklist: 1 of 2 ticked; open:').waitFor();
      await page.getByRole('listitem').filter({ hasText: /^Bays named$/ }).waitFor();
    } finally {
      for (const { id, ticked_by: by } of items) await tick(id, by !== null);
    }
  },

  async 'a decision that comes too late is refused in words'(page, world) {
    await page.route('**/review', (route) =>
      route.request().method() === 'POST'
        ? route.fulfill({ status: 409, contentType: 'application/problem+json', json: { title: 'Conflict', status: 409, detail: 'version 2 is approved meanwhile: look at it again' } })
        : route.continue(),
    );
    await openReview(page, world);
    await page.getByRole('button', { name: 'Remark' }).click();
    const dialog = page.getByRole('dialog');
    await dialog.getByLabel('Remark', { exact: true }).fill('too late');
    await dialog.getByRole('button', { name: 'Remark' }).click();
    await dialog.getByRole('alert').getByText('look at it again').waitFor();
    assert.equal(await dialog.getByLabel('Remark', { exact: true }).inputValue(), 'too late', 'what was written is not lost');
    page.faults = page.faults.filter((fault) => !fault.includes('409')); // the browser's own note of the refusal
  },

  async 'a remark is in the history for good'(page, world) {
    const text = `looked at by a check ${Date.now()}`;
    await openReview(page, world);
    await page.keyboard.press('H');
    await page.getByLabel('Remark', { exact: true }).fill(text);
    await page.getByRole('dialog').getByRole('button', { name: 'Remark' }).click();
    await page.getByRole('dialog').waitFor({ state: 'detached' });
    await page.locator('summary').filter({ hasText: 'History' }).click();
    await page.getByText(text).waitFor();
  },

  async 'a site has a checklist of its own'(page, world) {
    const { address, site } = world;
    const setList = (items) =>
      fetch(`${address}/api/v1/sites/${site.name}`, { method: 'PUT', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ review_checklist: items }) });
    const before = (await world.json(`/api/v1/sites/${site.name}`)).review_checklist;
    await setList(null);
    try {
      await openReview(page, world);
      await page.getByRole('region', { name: 'Checklist' }).getByRole('button', { name: 'Edit' }).click();
      const dialog = page.getByRole('dialog');
      await dialog.getByLabel('One item a line').fill('Ramps driven both ways\nCharging bays named\nLoops looked at');
      await dialog.getByRole('button', { name: 'Save' }).click();
      await dialog.waitFor({ state: 'detached' });
      await page.getByRole('checkbox', { name: 'Charging bays named' }).waitFor();
      const kept = (await world.json(`/api/v1/sites/${site.name}`)).review_checklist;
      assert.deepEqual(kept.map(({ text }) => text), ['Ramps driven both ways', 'Charging bays named', 'Loops looked at']);
      assert.equal(kept[2].id, 'loops', 'an item that stays is the same one');
      await page.getByRole('region', { name: 'Checklist' }).getByRole('button', { name: 'Edit' }).click();
      await dialog.getByRole('button', { name: 'The usual list' }).click();
      await page.getByRole('checkbox', { name: 'Slots sampled' }).waitFor();
      assert.equal((await world.json(`/api/v1/sites/${site.name}`)).review_checklist, null);
    } finally {
      await setList(before);
    }
  },

  async 'what awaits is listed, and nothing says so'(page, world) {
    const { address, site } = world;
    const asked = [];
    page.on('request', (request) => asked.push(new URL(request.url()).pathname));
    await page.goto(`${address}/review`);
    const { items } = await world.json(`/api/v1/sites/${site.name}/maps`);
    const awaited = items.filter(({ review_state: state, version }) => state === 'in_review' || (state === 'draft' && version === site.latest_version)); // older drafts are folded away
    if (awaited.length > 0) {
      await page.getByRole('link', { name: `${site.name} version ${awaited[0].version}`, exact: true }).waitFor();
      await world.picture('awaiting');
    }
    assert.deepEqual(asked.filter((path) => path.includes('/maps/')), [], 'no version is asked for by itself');
    for (const list of ['sites', 'maps', 'comments'])
      await page.route(`**/api/v1/${list}?*`, (route) => route.fulfill({ json: { items: [], next_cursor: null } }));
    await page.reload();
    await page.getByRole('heading', { name: 'Nothing awaits a review' }).waitFor();
  },
};
