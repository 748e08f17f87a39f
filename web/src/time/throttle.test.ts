import { afterEach, beforeEach, expect, test, vi } from 'vitest';

import { Throttle } from './throttle';

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

test('the first at once, then the last of each pause', () => {
  const seen: number[] = [];
  const throttle = new Throttle<number>((value) => seen.push(value), 100);
  for (const value of [1, 2, 3]) throttle.call(value);
  expect(seen).toEqual([1]);
  vi.advanceTimersByTime(100);
  expect(seen).toEqual([1, 3]);
  vi.advanceTimersByTime(500);
  throttle.call(4);
  expect(seen).toEqual([1, 3, 4]);
});

test('flush does what waits, once', () => {
  const seen: number[] = [];
  const throttle = new Throttle<number>((value) => seen.push(value), 100);
  throttle.call(1);
  throttle.call(2);
  throttle.flush();
  vi.advanceTimersByTime(500);
  expect(seen).toEqual([1, 2]);
});
