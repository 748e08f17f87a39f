import { expect, test } from 'vitest';

import { degreesText, graticuleOf, stepFor } from './graticule';

test('steps are round, and there are never many lines', () => {
  expect(stepFor(360)).toBe(45);
  expect(stepFor(80)).toBe(10);
  expect(stepFor(8)).toBe(1);
  expect(stepFor(0.04)).toBe(0.005);
  expect(stepFor(0.0016)).toBe(0.0002);
  for (let span = 400; span > 1e-4; span *= 0.9) {
    const lines = span / stepFor(span);
    expect(lines).toBeGreaterThan(1.9);
    expect(lines).toBeLessThan(8.01);
  }
});

test('lines cover the view, on multiples of the step', () => {
  const lines = graticuleOf([11.57, 48.13, 11.61, 48.15]);
  const meridians = lines.filter(({ isMeridian }) => isMeridian).map(({ at }) => at);
  expect(meridians[0]).toBe(11.57);
  expect(meridians.at(-1)).toBe(11.61);
  expect(meridians).toContain(11.575);
  const parallels = lines.filter(({ isMeridian }) => !isMeridian).map(({ at }) => at);
  expect(Math.min(...parallels)).toBeLessThanOrEqual(48.13);
  expect(Math.max(...parallels)).toBeGreaterThanOrEqual(48.15);
  expect(graticuleOf([-180, -89, 180, 89]).flatMap(({ line }) => line.map(([, latitude]) => Math.abs(latitude)))).not.toContain(89);
});

test('labels have as many digits as lines need', () => {
  expect(degreesText(11.575, true, 0.005)).toBe('11.575° E');
  expect(degreesText(-30, false, 10)).toBe('30° S');
});
