import { expect, test } from 'vitest';

import { placeAt, thinned, valueAt, type Track } from './track';

const track: Track = {
  start: '1767229200.000000000',
  poses: [0, 1, 2, 3].map((time) => ({ time, position: [2 * time, 0, 0.5], orientation: [0, 0, 0, 1] })),
};

test('places lie between poses, and nowhere beyond the ends', () => {
  expect(placeAt(track, 1.25)).toEqual([2.5, 0, 0.5]);
  expect(placeAt(track, 0)).toEqual([0, 0, 0.5]);
  expect(placeAt(track, 3.2)).toEqual([6, 0, 0.5]);
  expect(placeAt(track, 4)).toBeNull();
  expect(placeAt({ start: '0', poses: [] }, 0)).toBeNull();
});

test('a thinned way keeps both ends', () => {
  expect(thinned(track, 3).map(({ time }) => time)).toEqual([0, 2, 3]);
  expect(thinned(track, 0.1)).toHaveLength(4);
});

test('numbers of a series hold as long as they reach', () => {
  const series = { times: [10, 11, 20], values: [1, 3, 5] };
  expect(valueAt(series, 10.5, 1)).toBe(2);
  expect(valueAt(series, 11.5, 1)).toBe(3); // the next one is too far off to go between
  expect(valueAt(series, 19.5, 1)).toBe(5);
  expect(valueAt(series, 15, 1)).toBeNull();
  expect(valueAt(series, 9.5, 1)).toBe(1);
  expect(valueAt(series, 8, 1)).toBeNull();
  expect(valueAt(series, 20.5, 1)).toBe(5);
  expect(valueAt(series, 22, 1)).toBeNull();
  expect(valueAt({ times: [], values: [] }, 1, 1)).toBeNull();
});
