import { expect, test } from 'vitest';

import type { Plots } from '../../api/types';
import { kQuantities, niceEnd, quantityAt } from './path_colors';

test('scales end at round numbers that hold all but outliers', () => {
  expect(niceEnd([0.1, 1.2, 4.4])).toBe(5);
  expect(niceEnd([0.0017])).toBe(0.002);
  expect(niceEnd([...Array.from({ length: 99 }, () => 0.9), 50])).toBe(1);
  expect(niceEnd([])).toBe(1);
  expect(niceEnd([0, NaN])).toBe(1);
});

test('the worst camera counts, in milliradians', () => {
  const series = (camera: string, value: number) => ({
    name: 'residual' as const, camera, unit: 'rad', about: '', count: 1, times: [5], values: [value],
  });
  const plots = { series: [series('cam0', 0.001), series('cam1', 0.004)] } as unknown as Plots;
  expect(quantityAt(plots, kQuantities.residual, 5)).toBeCloseTo(4);
  expect(quantityAt(plots, kQuantities.residual, 50)).toBeNull();
  expect(quantityAt(plots, kQuantities.speed, 5)).toBeNull();
});
