import { afterEach, describe, expect, test, vi } from 'vitest';

import { changeHeaders } from './client';
import { fetchSession, mayReview, mayUpload, seesDrives, shareIn, signIn, type Caller, type Role } from './session';

const caller = (role: Role): Caller => ({ name: 'anne', role, sites: null, version: null, pictures: false });

afterEach(() => vi.unstubAllGlobals());

describe('shareIn', () => {
  test('takes the secret of a link and nothing else', () => {
    expect(shareIn('#share=parkade_share_aB-_9')).toBe('parkade_share_aB-_9');
    for (const other of ['', '#share=', '#share=parkade_token_a', '#share=parkade_share_a b', 'share=parkade_share_a'])
      expect(shareIn(other)).toBeNull();
  });
});

test('roles open what the service lets them do', () => {
  const roles: Role[] = ['viewer', 'uploader', 'reviewer', 'admin', 'link'];
  expect(roles.filter((role) => mayUpload(caller(role)))).toEqual(['uploader', 'admin']);
  expect(roles.filter((role) => mayReview(caller(role)))).toEqual(['reviewer', 'admin']);
  expect(roles.filter((role) => !seesDrives(caller(role)))).toEqual(['link']);
});

test('changes carry what the session was begun with', async () => {
  const answers = [
    { access: 'token', caller: caller('admin'), csrf: 'abc' },
    { access: 'open', caller: caller('admin'), csrf: null },
  ];
  vi.stubGlobal('fetch', async () => new Response(JSON.stringify(answers.shift()), { status: 200 }));
  await signIn('parkade_token_x');
  expect(changeHeaders()).toEqual({ 'x-csrf-token': 'abc' });
  await fetchSession();
  expect(changeHeaders()).toEqual({});
});

test('a refusal is told in the words of the service', async () => {
  vi.stubGlobal('fetch', async () => new Response('{"detail": "this token is unknown"}', { status: 401 }));
  await expect(signIn('x')).rejects.toThrow('this token is unknown');
});
