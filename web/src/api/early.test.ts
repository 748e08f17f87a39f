import { afterEach, expect, test, vi } from 'vitest';

import { askEarly, takeEarly } from './early';

const answering = (...statuses: number[]) => {
  const fetched = vi.fn(() => Promise.resolve(new Response(`answer ${fetched.mock.calls.length}`, { status: statuses[fetched.mock.calls.length - 1] ?? 200 })));
  vi.stubGlobal('fetch', fetched);
  vi.stubGlobal('location', { href: 'http://service/sites' });
  return fetched;
};

afterEach(() => void vi.unstubAllGlobals());

test('an answer is fetched once, and read by both who asked', async () => {
  const fetched = answering();
  const early = askEarly('/map');
  expect(await (await takeEarly('http://service/map'))?.text()).toBe('answer 1');
  expect(await (await early).text()).toBe('answer 1');
  expect(fetched).toHaveBeenCalledTimes(1);
});

test('it is taken once, and nothing else is', async () => {
  answering();
  void askEarly('/map?a=1');
  expect(takeEarly('/map')).toBeUndefined();
  expect(takeEarly('/map?a=1')).toBeDefined();
  expect(takeEarly('/map?a=1')).toBeUndefined();
});

test('whoever signed in since asks anew; other refusals stay', async () => {
  const fetched = answering(401, 200, 404);
  void askEarly('/map');
  expect((await takeEarly('/map'))?.status).toBe(200);
  void askEarly('/lost');
  expect((await takeEarly('/lost'))?.status).toBe(404);
  expect(fetched).toHaveBeenCalledTimes(3);
});

test('a service that was silent is asked again', async () => {
  const fetched = vi.fn().mockRejectedValueOnce(new TypeError('network')).mockResolvedValueOnce(new Response('here'));
  vi.stubGlobal('fetch', fetched);
  vi.stubGlobal('location', { href: 'http://service/sites' });
  askEarly('/map').catch(() => undefined);
  expect(await (await takeEarly('/map'))?.text()).toBe('here');
});
