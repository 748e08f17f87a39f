// The frame of all pages: places, roles, signing in, narrow screens.
import assert from 'node:assert/strict';

import { counted } from '../browser.mjs';

import { playRole } from '../roles.mjs';

const places = (page) => page.getByRole('navigation', { name: 'Places' }).getByRole('link').allInnerTexts();
const nothing = { json: { items: [], next_cursor: null } };
const problem = (status, code, detail) => ({ status, json: { type: 'about:blank', title: 'Refused', status, code, detail } });

export const checks = {
  async 'a new place has its title and the focus; back comes back'(page, { address }) {
    await page.goto(`${address}/sites`);
    await page.waitForFunction(() => document.title.startsWith('Sites'));
    await page.getByRole('link', { name: 'Settings', exact: true }).click();
    await page.waitForFunction(() => document.title.includes('Settings'));
    await page.waitForFunction(() => document.activeElement?.tagName === 'H1' && document.activeElement.textContent === 'Settings');
    await page.goBack();
    await page.waitForFunction(() => location.pathname === '/sites' && document.title.startsWith('Sites'));
    await page.waitForFunction(() => document.querySelector('main').contains(document.activeElement));
  },

  async 'an address that leads nowhere says so'(page, { address }) {
    await page.goto(`${address}/sites/lot/maps/1/2/3`);
    await page.getByRole('heading', { name: 'There is nothing at this address' }).waitFor();
    await page.getByText('/sites/lot/maps/1/2/3').waitFor();
    page.faults = page.faults.filter((fault) => !/404.*maps\/1\/2\/3$/.test(fault)); // the page may come as an answer of 404
    await page.getByRole('main').getByRole('link', { name: 'All sites' }).click();
    await page.waitForURL('**/sites');
  },

  async 'the first Tab skips to the content'(page, { address }) {
    await page.goto(`${address}/settings`);
    await page.getByRole('heading', { name: 'Settings' }).waitFor();
    await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    assert.equal(await page.evaluate(() => document.activeElement.id), 'place');
    assert.equal(new URL(page.url()).hash, '');
  },

  async 'each role is shown what it may'(page, { address }) {
    const all = ['Sites', 'Drives', 'Jobs', 'Review'];
    const shown = { link: ['Sites'], viewer: all, uploader: all, reviewer: [...all, 'Settings'], admin: [...all, 'Settings'] };
    for (const [role, expected] of Object.entries(shown)) {
      await page.unrouteAll({ behavior: 'ignoreErrors' });
      await playRole(page, { name: 'robin', role });
      await page.goto(`${address}/sites`);
      await page.locator('[data-caller]').waitFor();
      assert.deepEqual(await places(page), expected, role);
      await counted(page.getByRole('banner').getByRole('link', { name: 'Upload' }), role === 'uploader' || role === 'admin' ? 1 : 0, role);
      assert.match(await page.locator('[data-caller]').innerText(), role === 'link' ? /shared with robin/ : new RegExp(`robin · ${role}`));
    }
  },

  async 'a visitor by a link is told what takes a token'(page, { address }) {
    await playRole(page, { name: 'Fleet north', role: 'link' });
    await page.goto(`${address}/jobs`);
    await page.getByRole('heading', { name: 'A share link shows maps only' }).waitFor();
  },

  async 'a wrong token is refused in words, a right one leads to where one wanted to go'(page, { address }) {
    const caller = { name: 'rita', role: 'viewer', sites: null, version: null, pictures: false };
    let isIn = false;
    await page.route('**/api/v1/session', (route) => {
      const request = route.request();
      if (request.method() === 'POST') {
        isIn = request.postDataJSON().token === 'parkade_token_right';
        if (!isIn) return route.fulfill(problem(401, 'unauthenticated', 'this token lets nobody in'));
      }
      return route.fulfill({ status: request.method() === 'POST' ? 201 : 200, json: { access: 'token', caller: isIn ? caller : null, csrf: isIn ? 'played' : null } });
    });
    await page.goto(`${address}/settings/access`);
    await page.getByLabel('Your token').fill('parkade_token_wrong');
    await page.keyboard.press('Enter');
    await page.getByRole('alert').getByText('This token lets nobody in').waitFor();
    assert.ok((await page.title()).startsWith('Sign in'));
    page.faults.length = 0;
    await page.getByLabel('Your token').fill('parkade_token_right');
    await page.keyboard.press('Enter');
    await page.getByText('Settings are for admins').waitFor();
  },

  async 'a session that ended asks for the token again, and stays at its place'(page, { address }) {
    await playRole(page, { name: 'anne', role: 'admin' });
    await page.route('**/api/v1/audit?*', (route) => route.fulfill(problem(401, 'unauthenticated', 'this takes a token')));
    await page.route('**/api/v1/tokens?*', (route) => route.fulfill(nothing));
    await page.goto(`${address}/settings/access`);
    await page.getByRole('link', { name: 'Audit log' }).click();
    await page.getByRole('alert').getByText('Your session has ended').waitFor();
    assert.equal(new URL(page.url()).pathname, '/settings/audit');
    page.faults.length = 0;
  },

  async 'the secret of a share link leaves the address at once, and a dead one is said to be dead'(page, { address, site }) {
    const posted = [];
    await page.route('**/api/v1/session', (route) => {
      if (route.request().method() === 'GET') return route.fulfill({ json: { access: 'token', caller: null, csrf: null } });
      posted.push(route.request().postDataJSON().token);
      return route.fulfill(problem(401, 'unauthenticated', 'it was revoked'));
    });
    await page.goto(`${address}/sites/${site.name}#share=parkade_share_a-b_c`);
    await page.getByRole('alert').getByText('This link does not work').waitFor();
    assert.deepEqual(posted, ['parkade_share_a-b_c']);
    assert.equal(page.url(), `${address}/sites/${site.name}`);
    page.faults.length = 0;
  },

  async 'narrow screens keep all of it within reach'(page, { address, picture }) {
    await page.setViewportSize({ width: 390, height: 800 });
    for (const path of ['/sites', '/settings/access', '/settings/audit']) {
      await page.goto(address + path);
      await page.getByRole('navigation', { name: 'Places' }).waitFor();
      const [wide, room] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
      assert.ok(wide <= room, `${path} is ${wide} px wide on ${room}`);
    }
    const keys = page.getByRole('banner').getByRole('button', { name: 'Keys' });
    assert.ok(!(await keys.isVisible()));
    await page.getByRole('button', { name: 'More' }).click();
    await keys.waitFor();
    await picture('shell_narrow');
    await page.keyboard.press('Escape');
    await keys.waitFor({ state: 'hidden' });
    await page.getByRole('button', { name: 'More' }).click();
    await keys.click();
    await page.getByRole('dialog', { name: 'Keys' }).waitFor();
  },

  async 'the colors that were chosen stay'(page, { address }) {
    await page.goto(`${address}/sites`);
    const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    await page.getByLabel('Colors').selectOption('dark');
    const dark = await background();
    await page.reload();
    await page.getByLabel('Colors').waitFor();
    assert.equal(await background(), dark);
    await page.getByLabel('Colors').selectOption('light');
    assert.notEqual(await background(), dark);
    await page.getByLabel('Colors').selectOption('system');
  },
};
