import { afterEach, beforeEach, expect, test, vi } from 'vitest';

import { PictureFeed, widthFor } from './picture_feed.svelte';

interface Asked {
  address: string;
  signal: AbortSignal;
  answer: (response: Response) => void;
}
let asked: Asked[] = [];

beforeEach(() => {
  asked = [];
  vi.stubGlobal('fetch', (address: string, { signal }: { signal: AbortSignal }) =>
    new Promise<Response>((answer, refuse) => {
      asked.push({ address, signal, answer });
      signal.addEventListener('abort', () => refuse(new Error('aborted')));
    }),
  );
});
afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

const settled = () => new Promise((resolve) => setTimeout(resolve, 5));
const picture = (time: string) =>
  new Response('jpeg', { headers: { 'picture-time': time, 'picture-full-size': '640x400' } });

test('one question at a time, then the latest', async () => {
  const feed = new PictureFeed();
  for (const address of ['/a', '/b', '/c']) feed.want(address);
  expect(asked.map(({ address }) => address)).toEqual(['/a']);
  expect(feed.isLoading).toBe(true);
  asked[0]!.answer(picture('1.000000000'));
  await settled();
  expect(asked.map(({ address }) => address)).toEqual(['/a', '/c']);
  expect(feed.picture).toBeNull(); // nobody wants the first any more
  asked[1]!.answer(picture('3.000000000'));
  await settled();
  expect(feed.picture).toMatchObject({ address: '/c', time: '3.000000000', width: 640, height: 400 });
  expect(feed.isLoading).toBe(false);
  expect(feed.offsetFrom('2.500000000')).toBeCloseTo(0.5);
  feed.want('/a'); // kept
  expect(feed.picture?.address).toBe('/a');
  expect(asked).toHaveLength(2);
});

test('the next one is got ready, after the one that is wanted', async () => {
  const feed = new PictureFeed();
  feed.want('/a', '/b');
  asked[0]!.answer(picture('1.0'));
  await settled();
  expect(asked.map(({ address }) => address)).toEqual(['/a', '/b']);
  expect(feed.isLoading).toBe(false);
  asked[1]!.answer(picture('2.0'));
  await settled();
  expect(feed.picture?.address).toBe('/a');
  feed.want('/b');
  expect(feed.picture?.address).toBe('/b');
});

test('a slow picture that nobody wants any more is given up', async () => {
  const now = vi.spyOn(performance, 'now').mockReturnValue(0);
  const feed = new PictureFeed();
  feed.want('/a');
  now.mockReturnValue(600);
  feed.want('/b');
  await settled();
  expect(asked[0]!.signal.aborted).toBe(true);
  expect(asked.map(({ address }) => address)).toEqual(['/a', '/b']);
  now.mockRestore();
});

test('why there is none is said, and the picture before is not shown for it', async () => {
  const feed = new PictureFeed();
  feed.want('/a');
  asked[0]!.answer(picture('1.0'));
  await settled();
  feed.want('/b');
  asked[1]!.answer(new Response(JSON.stringify({ detail: 'no image within a second' }), { status: 404 }));
  await settled();
  expect(feed.complaint).toBe('no image within a second');
  expect(feed.picture).toBeNull();
});

test('while the service reads the log, it is asked again', async () => {
  const feed = new PictureFeed();
  feed.want('/a');
  asked[0]!.answer(new Response('', { status: 503, headers: { 'retry-after': '0' } }));
  await settled();
  expect(feed.isWaiting).toBe(true);
  expect(asked).toHaveLength(2);
  asked[1]!.answer(picture('1.0'));
  await settled();
  expect(feed.isWaiting).toBe(false);
  expect(feed.picture?.address).toBe('/a');
});

test('nothing is asked after its end', async () => {
  const feed = new PictureFeed();
  feed.want('/a');
  feed.want('/b');
  feed.dispose();
  await settled();
  expect(asked).toHaveLength(1);
});

test('few widths', () => {
  expect(widthFor(170, 1)).toBe(160);
  expect(widthFor(200, 1)).toBe(320);
  expect(widthFor(200, 3)).toBe(480);
  expect(widthFor(5000, 1)).toBe(1920);
});
