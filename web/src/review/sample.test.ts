import { expect, test } from 'vitest';

import { sampleOf } from './sample';

const kIds = Array.from({ length: 100 }, (_, i) => `slot_${i}`);

test('a sample is the same in any order, and from all over', () => {
  const sample = sampleOf(kIds, 5);
  expect(sample).toHaveLength(5);
  expect(new Set(sample).size).toBe(5);
  expect(sampleOf([...kIds].reverse(), 5)).toEqual(sample);
  const numbers = sampleOf(kIds, 20).map((id) => Number(id.slice(5)));
  expect(Math.min(...numbers)).toBeLessThan(30);
  expect(Math.max(...numbers)).toBeGreaterThan(70);
});

test('few are all taken', () => {
  expect(sampleOf(['b', 'a'], 5).sort()).toEqual(['a', 'b']);
});
