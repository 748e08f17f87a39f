import { afterEach, describe, expect, test, vi } from 'vitest';

import { addressOf, refusalIn, request, setCsrfToken } from './client';

interface Sent {
  address: string;
  init: RequestInit;
}

/** Answers every request so, and keeps what was sent. */
function answering(body: string, status = 200): Sent[] {
  const sent: Sent[] = [];
  vi.stubGlobal('fetch', async (address: string, init: RequestInit) => {
    sent.push({ address, init });
    return new Response(status === 204 ? null : body, { status });
  });
  return sent;
}

afterEach(() => {
  vi.unstubAllGlobals();
  setCsrfToken(null);
});

describe('addressOf', () => {
  test('fills segments and the query', () => {
    expect(addressOf('get', '/api/v1/jobs', { query: { state: 'running', limit: 5 } })).toBe('/api/v1/jobs?state=running&limit=5');
    expect(addressOf('get', '/api/v1/jobs', { query: { cursor: undefined } })).toBe('/api/v1/jobs');
    expect(addressOf('put', '/api/v1/drives', { query: { filename: 'a & b.bag' } })).toBe('/api/v1/drives?filename=a+%26+b.bag');
  });

  test('keeps folders of files, and lets no name leave its place', () => {
    const path = { site: '../lot', version: '3', file: 'drive 1/trajectory.tum' };
    expect(addressOf('get', '/api/v1/sites/{site}/maps/{version}/{file}', { path })).toBe(
      '/api/v1/sites/..%2Flot/maps/3/drive%201/trajectory.tum',
    );
  });
});

describe('request', () => {
  test('sends changes as JSON with the token of the session', async () => {
    const sent = answering('{}', 202);
    setCsrfToken('abc');

    await request('post', '/api/v1/sites/{site}/maps', { path: { site: 'lot' }, body: { from: 2 } });

    expect(sent[0]?.init).toEqual({
      method: 'POST',
      headers: { accept: 'application/json', 'x-csrf-token': 'abc', 'content-type': 'application/json' },
      body: '{"from":2}',
    });
  });

  test('sends no token with what changes nothing', async () => {
    const sent = answering('{"items": [], "next_cursor": null}');
    setCsrfToken('abc');

    expect((await request('get', '/api/v1/drives')).items).toEqual([]);

    expect(sent[0]?.init).toEqual({ method: 'GET', headers: { accept: 'application/json' } });
  });

  test('takes an empty answer', async () => {
    answering('', 204);
    expect(await request('delete', '/api/v1/session')).toBeUndefined();
  });

  test('throws the sentence of a problem', async () => {
    answering('{"type": "about:blank", "title": "Not Found", "status": 404, "detail": "there is no site \'lot\'", "code": "not_found"}', 404);
    await expect(request('get', '/api/v1/sites/{site}', { path: { site: 'lot' } })).rejects.toThrow(/^there is no site 'lot'$/);
  });

  test('says so where nobody answers', async () => {
    vi.stubGlobal('fetch', async () => {
      throw new TypeError('Failed to fetch');
    });
    await expect(request('get', '/api/v1/sites')).rejects.toThrow(/^the service does not answer$/);
  });
});

test('a refusal is always one sentence', () => {
  expect(refusalIn('{"detail": "the upload is empty", "title": "Bad Request"}', 400)).toBe('the upload is empty');
  expect(refusalIn('{"title": "Bad Gateway"}', 502)).toBe('Bad Gateway');
  for (const other of ['', '<html>', 'null', '{}', '"text"', '{"detail": null}'])
    expect(refusalIn(other, 502)).toBe('the service answered 502');
});
