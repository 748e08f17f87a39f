import { expect, test } from 'vitest';

import { secondsBetween } from '../api/map_files';
import { clockText, offsetText, stampAfter, tickText } from './drive_time';

test('a stamp keeps its nanoseconds, which a double loses', () => {
  expect(stampAfter('1767337200.001300000', 0)).toBe('1767337200.001300000');
  expect(stampAfter('1767337200.999999999', 0.000000001)).toBe('1767337201.000000000');
  expect(stampAfter('1767337200.001300001', 69.99)).toBe('1767337269.991300001');
  expect(stampAfter('0.5', 1.25)).toBe('1.750000000');
});

test('before the start, and before zero', () => {
  expect(stampAfter('1767337200.001300000', -0.0013)).toBe('1767337200.000000000');
  expect(stampAfter('0.250000000', -1)).toBe('-0.750000000');
  expect(stampAfter('-0.750000000', 1)).toBe('0.250000000');
});

test('it is the way back of secondsBetween', () => {
  const [start, stamp] = ['1767337200.001300000', '1767337214.213994435'];
  expect(stampAfter(start, secondsBetween(start, stamp))).toBe(stamp);
});

test('times are read like a clock', () => {
  expect(clockText(7.349)).toBe('0:07.35');
  expect(clockText(59.999)).toBe('1:00.00');
  expect(clockText(3727.5)).toBe('1:02:07.50');
  expect(clockText(-1)).toBe('0:00.00');
});

test('offsets', () => {
  expect(offsetText(0.0124)).toBe('+12 ms');
  expect(offsetText(-0.41)).toBe('−0.41 s');
  expect(offsetText(0)).toBe('+0 ms');
});

test('ticks say no more than their step', () => {
  expect(tickText(65, 5)).toBe('1:05');
  expect(tickText(60.5, 0.5)).toBe('1:00.5');
  expect(tickText(59.999999, 0.1)).toBe('1:00.0');
  expect(tickText(7.25, 0.05)).toBe('0:07.25');
});
