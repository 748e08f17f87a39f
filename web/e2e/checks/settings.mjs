// Tokens, webhooks and the audit log.
import assert from 'node:assert/strict';

import { playRole } from '../roles.mjs';

const kAdmin = { name: 'anne', role: 'admin', pictures: true };
const problem = (status, detail) => ({ status, json: { type: 'about:blank', title: 'Refused', status, code: 'conflict', detail } });

export const checks = {
  async 'while nobody needs a token, the page says what the first one changes'(page, { address, skip }) {
    if ((await fetch(`${address}/api/v1/session`).then((answer) => answer.json())).access !== 'open') skip('this service has tokens');
    await page.goto(`${address}/settings/access`);
    await page.getByRole('heading', { name: 'Nobody needs a token yet' }).waitFor();
    await page.getByText('There is no way back').waitFor();
    assert.equal(await page.getByRole('button', { name: 'New token' }).count(), 0);
  },

  async 'a token is made, shown once and revoked; its mistakes are said'(page, { address, site, picture }) {
    await playRole(page, kAdmin);
    const row = (changes) => ({ id: 'first', name: 'anne', role: 'admin', sites: null, pictures: true, created_at: '2026-01-01T00:00:00Z', expires_at: null, revoked_at: null, used_at: null, ...changes });
    const tokens = [row()];
    const bodies = [];
    await page.route('**/api/v1/tokens?*', (route) => route.fulfill({ json: { items: tokens, next_cursor: null } }));
    await page.route('**/api/v1/tokens', (route) => {
      const body = route.request().postDataJSON();
      bodies.push(body);
      if (body.name === 'twice') return route.fulfill(problem(409, 'the disk is full'));
      tokens.unshift(row({ id: 'second', ...body, days: undefined, expires_at: new Date(Date.now() + body.days * 86_400_000).toISOString() }));
      return route.fulfill({ status: 201, json: { ...tokens[0], token: 'parkade_token_shown-once' } });
    });
    const revoked = [];
    await page.route('**/api/v1/tokens/*', (route) => {
      revoked.push(new URL(route.request().url()).pathname.split('/').at(-1));
      tokens.find(({ id }) => id === revoked.at(-1)).revoked_at = new Date().toISOString();
      return route.fulfill({ status: 204 });
    });

    await page.goto(`${address}/settings/access`);
    await page.getByRole('button', { name: 'New token' }).click();
    await page.getByLabel('Whose it is').fill('twice');
    await page.getByLabel('Some: all else').check();
    await page.getByRole('button', { name: 'Make the token' }).click();
    await page.getByRole('alert').getByText('Choose a site at least').waitFor();
    await page.getByLabel(site.name, { exact: true }).check();
    await page.getByRole('button', { name: 'Make the token' }).click();
    await page.getByRole('alert').getByText('The disk is full').waitFor();
    page.faults.length = 0;

    await page.getByLabel('Whose it is').fill('car7');
    await page.getByRole('radio', { name: /^uploader/ }).check();
    await page.getByLabel('Sites that are not there yet').fill('level-2');
    await page.getByRole('button', { name: 'Make the token' }).click();
    assert.equal(await page.locator('[data-secret]').inputValue(), 'parkade_token_shown-once');
    assert.deepEqual(bodies.at(-1), { name: 'car7', role: 'uploader', sites: [site.name, 'level-2'], pictures: false, days: 90 });
    await picture('settings_tokens');
    await page.getByRole('button', { name: 'I have kept it' }).click();
    assert.equal(await page.getByText('shown-once').count(), 0);

    await page.getByRole('button', { name: 'Revoke anne' }).click();
    await page.getByRole('dialog').getByText('last admin token').waitFor();
    await page.keyboard.press('Escape');
    await page.getByRole('button', { name: 'Revoke car7' }).click();
    await page.getByRole('button', { name: 'Revoke it' }).click();
    await page.getByText('Show 1 that ended').waitFor();
    assert.deepEqual(revoked, ['second']);
  },

  async 'a webhook is added, tested and deleted; one that leads inside is refused'(page, { address, skip }) {
    if ((await fetch(`${address}/api/v1/session`).then((answer) => answer.json())).access !== 'open') skip('this service has tokens');
    const url = `https://hooks-${Date.now()}.invalid/maps`;
    await page.goto(`${address}/settings/webhooks`);
    await page.getByRole('button', { name: 'New webhook' }).click();
    await page.getByLabel('Address').fill('ftp://fleet.example/maps');
    await page.getByRole('button', { name: 'Add the webhook' }).click();
    await page.getByRole('alert').getByText(/begins with https/).waitFor();
    page.faults.length = 0;
    await page.getByLabel('Address').fill(url);
    await page.getByRole('checkbox', { name: /^published/ }).uncheck();
    await page.getByRole('button', { name: 'Add the webhook' }).click();
    await page.getByRole('alert').getByText('Choose an event').waitFor();
    await page.getByRole('checkbox', { name: /^reviewed/ }).check();
    await page.getByRole('button', { name: 'Add the webhook' }).click();
    assert.match(await page.locator('[data-secret]').inputValue(), /^[0-9a-f]{64}$/);
    await page.getByText('Nothing was sent yet').waitFor();
    await page.getByRole('button', { name: 'Send a test' }).click();
    await page.getByText(/tried once .* next try in/).waitFor({ timeout: 30_000 });
    await page.getByRole('button', { name: `Delete ${url}` }).click();
    await page.getByRole('button', { name: 'Delete it' }).click();
    await page.getByText(url).first().waitFor({ state: 'detached' });
  },

  async 'the audit log is read page by page, and found in'(page, { address, picture }) {
    let isBroken = true;
    const entry = (number) => ({ number, at: '2026-11-27T18:49:12.019Z', caller: { id: null, name: number === 1 ? 'anne' : 'car7' }, address: null, action: 'map.review', subject: 'lot/2', detail: { to: 'approved' }, sha256: '' });
    await page.route('**/api/v1/audit?*', (route) => {
      if (isBroken) return route.fulfill(problem(500, 'the database does not answer'));
      const isSecond = route.request().url().includes('cursor=');
      return route.fulfill({ json: isSecond ? { items: [entry(1)], next_cursor: null } : { items: [entry(3), entry(2)], next_cursor: '2' } });
    });
    await page.goto(`${address}/settings/audit`);
    await page.getByRole('alert').getByText('The database does not answer').waitFor();
    page.faults.length = 0;
    isBroken = false;
    await page.getByRole('button', { name: 'Try again' }).click();
    await page.getByText('the newest 2 entries').waitFor();
    await page.getByLabel('Find by').fill('anne judged');
    await page.getByText('0 of the newest 2 entries').waitFor();
    await page.getByRole('button', { name: 'Look further back' }).click();
    await page.getByText('1 of 3 entries').waitFor();
    assert.equal(await page.getByRole('link', { name: 'lot/2' }).getAttribute('href'), '/sites/lot/maps/2');
    await picture('settings_audit');
  },

  async 'settings are for those who may'(page, { address }) {
    await playRole(page, { name: 'vera', role: 'viewer' });
    await page.goto(`${address}/settings/access`);
    await page.getByRole('heading', { name: 'Settings are for admins' }).waitFor();
    assert.equal(await page.getByRole('navigation', { name: 'Settings' }).count(), 0);
  },

  async 'a reviewer has the share links only'(page, { address }) {
    await playRole(page, { name: 'rita', role: 'reviewer' });
    await page.route('**/api/v1/shares?*', (route) => route.fulfill({ json: { items: [], next_cursor: null } }));
    await page.goto(`${address}/settings/access`);
    await page.getByRole('heading', { name: 'No link leads anywhere now' }).waitFor();
    assert.deepEqual(await page.getByRole('navigation', { name: 'Settings' }).getByRole('link').allInnerTexts(), ['Share links']);
  },
};
