import { describe, expect, test } from 'vitest';

import { formatArea, formatBytes, formatDuration, formatMeters } from './format';

describe('formatBytes', () => {
  test('keeps three figures', () => {
    expect(formatBytes(999)).toBe('999 B');
    expect(formatBytes(1000)).toBe('1.0 kB');
    expect(formatBytes(123_456_789)).toBe('123 MB');
    expect(formatBytes(2_500_000_000_000)).toBe('2.5 TB');
  });
});

describe('formatDuration', () => {
  test('uses the two largest units', () => {
    expect(formatDuration(7.4)).toBe('7 s');
    expect(formatDuration(125)).toBe('2 min 05 s');
    expect(formatDuration(3840)).toBe('1 h 04 min');
  });
  test('is never negative', () => expect(formatDuration(-3)).toBe('0 s'));
});

test('lengths and areas', () => {
  expect(formatMeters(3.14159)).toBe('3.14 m');
  expect(formatMeters(120.4)).toBe('120 m');
  expect(formatMeters(1234)).toBe('1.23 km');
  expect(formatArea(12345.6)).toBe('12,346 m²');
});
