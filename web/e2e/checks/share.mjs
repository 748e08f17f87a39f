// What leaves the page: the address of a view, links for people without a token, files.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';

import { mapShown } from '../browser.mjs';
import { playRole } from '../roles.mjs';

async function openShare(page, { address, site }) {
  await page.goto(`${address}/sites/${site.name}/maps/latest?tab=share`);
  await mapShown(page, `${site.name}/${site.latest_version}`);
}

/** Answers for share links as the service gives them, kept here: this service may have no tokens. */
async function playShares(page, site) {
  const links = [];
  const posted = [];
  await page.route('**/api/v1/shares?*', (route) => route.fulfill({ json: { items: links, next_cursor: null } }));
  await page.route('**/api/v1/shares', (route) => {
    const body = route.request().postDataJSON();
    posted.push({ body, csrf: route.request().headers()['x-csrf-token'] });
    if (body.name === 'nobody') return route.fulfill({ status: 400, json: { type: 'about:blank', title: 'Bad Request', status: 400, code: 'invalid_input', detail: '"name" is too long' } });
    const link = { id: 'abc', name: body.name, site: site.name, version: body.version, created_by: 'anne', created_at: new Date().toISOString(), expires_at: new Date(Date.now() + body.days * 86_400_000).toISOString(), revoked_at: null };
    links.push(link);
    return route.fulfill({ status: 201, json: { ...link, token: 'parkade_share_secret-1', url: '/#share=parkade_share_secret-1' } });
  });
  await page.route('**/api/v1/shares/abc', (route) => {
    links[0].revoked_at = new Date().toISOString();
    return route.fulfill({ status: 204 });
  });
  return posted;
}

export const checks = {
  async 'the address of a view is copied, and leads back to this version and camera'(page, world) {
    await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
    await openShare(page, world);
    await page.getByRole('button', { name: 'From above' }).click();
    await page.waitForFunction(() => new URLSearchParams(location.search).has('view'));
    await page.getByRole('button', { name: 'Copy the address of this view' }).click();
    await page.getByRole('button', { name: 'Copied' }).waitFor();
    const copied = new URL(await page.evaluate(() => navigator.clipboard.readText()));
    assert.equal(copied.pathname, `/sites/${world.site.name}/maps/${world.site.latest_version}`, 'a number, not "latest"');
    await page.goto(copied.href);
    await mapShown(page, `${world.site.name}/${world.site.latest_version}`);
    await page.waitForFunction((view) => new URLSearchParams(location.search).get('view') === view, copied.searchParams.get('view'));
  },

  async 'every file is there with its size, and comes under a name that says which map it is of'(page, world) {
    await openShare(page, world);
    const { files } = await world.json(`/api/v1/sites/${world.site.name}/maps/${world.site.latest_version}`);
    const listed = await page.locator('#details a[download][href^="/api/"]').evaluateAll((links) => links.map((link) => decodeURIComponent(link.pathname)));
    assert.deepEqual(listed.map((path) => path.split('/').slice(7).join('/')).sort(), files.map(({ name }) => name).sort());
    assert.ok(!(await page.getByRole('link', { name: 'Download surface.bin' }).isVisible()), 'steps in between are folded away');
    const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('link', { name: /^Download map\.glb/ }).click()]);
    assert.equal(download.suggestedFilename(), `${world.site.name}-${world.site.latest_version}-map.glb`);
    assert.equal((await readFile(await download.path())).length, files.find(({ name }) => name === 'map.glb').bytes);
    const [sums] = await Promise.all([page.waitForEvent('download'), page.getByRole('link', { name: 'Checksums' }).click()]);
    assert.match(await readFile(await sums.path(), 'utf8'), new RegExp(`^[0-9a-f]{64}  ${world.site.name}-${world.site.latest_version}-map\\.glb$`, 'm'));
    await world.picture('share');
  },

  async 'a reviewer makes a link, sees it once, and revokes it; a refusal says why'(page, world) {
    await playRole(page, { name: 'anne', role: 'reviewer' });
    const posted = await playShares(page, world.site);
    await openShare(page, world);
    await page.getByRole('button', { name: 'New link' }).click();
    await page.getByLabel('Whom it is for').fill('nobody');
    await page.getByRole('button', { name: 'Make the link' }).click();
    await page.getByRole('alert').getByText('"name" is too long').waitFor();
    page.faults.length = 0; // the browser's own line about the refusal

    await page.getByLabel('Whom it is for').fill('Fleet north');
    await page.getByLabel('Ends after').selectOption('7');
    await page.getByRole('button', { name: 'Make the link' }).click();
    const address = new URL(await page.locator('[data-secret]').inputValue());
    assert.deepEqual(posted.at(-1), { body: { name: 'Fleet north', site: world.site.name, version: world.site.latest_version, days: 7 }, csrf: 'played' });
    assert.equal(address.hash, '#share=parkade_share_secret-1');
    assert.equal(address.pathname, `/sites/${world.site.name}/maps/${world.site.latest_version}`);
    assert.ok(!address.searchParams.has('tab'), 'a visitor is not led to this panel');
    await page.getByText(/ends in (6|7) days/).waitFor();
    await page.getByRole('button', { name: 'I have kept it' }).click();
    assert.equal(await page.locator('[data-secret]').count(), 0);

    await page.getByRole('button', { name: 'Revoke the link for Fleet north' }).click();
    await page.getByRole('dialog').getByRole('button', { name: 'Revoke it' }).click();
    await page.getByText('No link leads here now.').waitFor();
    await page.getByRole('checkbox', { name: /Show 1 that/ }).check();
    await page.getByText(/revoked just now/).waitFor();
  },

  async 'without tokens no link is offered, and why'(page, world) {
    if ((await world.json('/api/v1/session')).access !== 'open') world.skip('this service has tokens');
    await openShare(page, world);
    await page.getByText('the address above is enough').waitFor();
    assert.equal(await page.getByRole('button', { name: 'New link' }).count(), 0);
  },
};
