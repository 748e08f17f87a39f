// What is not in the description of the service does not compile: `vitest --typecheck` and tsc look.

import { describe, expectTypeOf, test } from 'vitest';

import { addressOf, request, type Schemas } from './client';

const site = { path: { site: 'lot' } };

describe('mistakes', () => {
  test('in addresses and methods', () => {
    // @ts-expect-error no such address
    void request('get', '/api/v1/drivers');
    // @ts-expect-error no such method of this one
    void request('patch', '/api/v1/drives');
    // @ts-expect-error its segment is missing
    void request('get', '/api/v1/sites/{site}');
    // @ts-expect-error its segment has another name
    void addressOf('get', '/api/v1/sites/{site}', { path: { name: 'lot' } });
  });

  test('in parameters', () => {
    // @ts-expect-error no such parameter
    void request('get', '/api/v1/jobs', { query: { status: 'running' } });
    // @ts-expect-error no such state
    void request('get', '/api/v1/jobs', { query: { state: 'finished' } });
    // @ts-expect-error a number
    void addressOf('get', '/api/v1/jobs', { query: { limit: 'all' } });
  });

  test('in bodies', () => {
    // @ts-expect-error nothing to sign in with
    void request('post', '/api/v1/session');
    // @ts-expect-error no such member
    void request('post', '/api/v1/session', { body: { secret: 'x' } });
    // @ts-expect-error a pin has a latitude
    void request('post', '/api/v1/sites/{site}/maps', { ...site, body: { pins: [{ point: [0, 0, 0] }] } });
    // @ts-expect-error a point has three numbers
    void request('post', '/api/v1/sites/{site}/maps', { ...site, body: { pins: [{ point: [0, 0], latitude: 1, longitude: 2 }] } });
    // @ts-expect-error GET has no body
    void request('get', '/api/v1/drives', { body: {} });
  });

  test('in answers', () => {
    // @ts-expect-error no such member
    void request('get', '/api/v1/drives').then((page) => page.drives);
  });
});

test('answers are those described', () => {
  expectTypeOf(request('get', '/api/v1/sites/{site}', site)).resolves.toEqualTypeOf<Schemas['Site']>();
  expectTypeOf(request('post', '/api/v1/sites/{site}/maps', site)).resolves.toEqualTypeOf<Schemas['Job']>();
  expectTypeOf(request('delete', '/api/v1/session')).resolves.toEqualTypeOf<undefined>();
});
