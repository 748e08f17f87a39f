import { expect, test } from 'vitest';

import { sayTime, sayWhen } from './when';

const kNow = Date.parse('2026-11-27T12:00:00Z');

test('times are said by how far they are', () => {
  expect(sayWhen('2026-11-27T11:59:30Z', kNow)).toBe('just now');
  expect(sayWhen('2026-11-27T11:54:30Z', kNow)).toBe('5 min ago');
  expect(sayWhen('2026-11-27T15:00:00Z', kNow)).toBe('in 3 h');
  expect(sayWhen('2026-11-26T10:00:00Z', kNow)).toBe('26 h ago');
  expect(sayWhen('2026-12-27T11:59:58Z', kNow)).toBe('in 30 days');
});

test('the day comes before the hour, in two digits each', () => {
  expect(sayTime(new Date(2026, 0, 2, 3, 4).toISOString())).toBe('2026-01-02 03:04');
});
