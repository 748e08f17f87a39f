import { describe, expect, test } from 'vitest';

import type { Plots } from '../api/types';
import { degradedAt, isThinned, plotsOf, rangeOf, shows, valueNear, widened, windowWithin, withStretch } from './plot_model';

function series(name: Plots['series'][number]['name'], values: number[], camera?: string): Plots['series'][number] {
  return { name, unit: '', about: name, count: values.length, times: values.map((_, i) => i), values, ...(camera ? { camera } : {}) };
}

describe('plotsOf', () => {
  test('groups by what is read together, in the units that people read', () => {
    const plots = plotsOf({
      series: [
        series('gnss_sigma', [1]),
        series('sigma_yaw', [Math.PI / 180]),
        series('residual', [0.0012], 'cam0'),
        series('residual', [0.002], 'cam1'),
        series('gnss_error', [2]),
        series('speed', [3]),
      ],
    });
    expect(plots.map(({ key }) => key)).toEqual(['speed', 'residual', 'yaw', 'gnss']);
    const [, residual, yaw, gnss] = plots;
    expect(residual!.unit).toBe('mrad');
    expect(residual!.lines.map(({ label, values }) => [label, values[0]])).toEqual([['cam0', 1.2], ['cam1', 2]]);
    expect(yaw!.lines[0]!.values[0]).toBeCloseTo(1, 12);
    expect(gnss!.lines.map(({ label }) => label)).toEqual(['as declared', 'off the trajectory']);
  });
  test('a drive without wheels has no plot of them', () => {
    expect(plotsOf({ series: [series('wheel_slip', [])] })).toEqual([]);
  });
});

test('valueNear takes the nearest, and none from far off', () => {
  const line = { times: [1, 2, 4], values: [10, 20, 40] };
  expect(valueNear(line, 1.4, 1)).toBe(10);
  expect(valueNear(line, 1.6, 1)).toBe(20);
  expect(valueNear(line, 9, 10)).toBe(40);
  expect(valueNear(line, 3, 0.5)).toBeNull();
  expect(valueNear({ times: [], values: [] }, 1, 10)).toBeNull();
});

test('degradedAt', () => {
  const stretches = [{ begin: 1, end: 2, reason: 'dark' }];
  expect(degradedAt(stretches, 1.5)?.reason).toBe('dark');
  expect(degradedAt(stretches, 2.01)).toBeNull();
});

describe('windowWithin', () => {
  test('stays in the drive', () => {
    expect(windowWithin([-5, 3], 10)).toEqual([0, 8]);
    expect(windowWithin([8, 12], 10)).toEqual([6, 10]);
    expect(windowWithin([-5, 50], 10)).toEqual([0, 10]);
  });
  test('is never shorter than what can be told apart', () => {
    const [from, to] = windowWithin([4, 4.001], 10);
    expect(to - from).toBeCloseTo(0.2);
    expect((from + to) / 2).toBeCloseTo(4.0005);
  });
});

test('a stretch is asked for that a window can be moved in', () => {
  expect(widened([40, 50], 100)).toEqual([30, 60]);
  expect(widened([5, 15], 20)).toEqual([0, 20]);
});

test('a stretch shows what it has, and a thinned one no small part of it', () => {
  expect(shows([0, 100], true, [40, 70])).toBe(false); // others lie between what was kept
  expect(shows([30, 60], true, [40, 50])).toBe(true);
  expect(shows([30, 60], true, [45, 48])).toBe(false);
  expect(shows([30, 60], false, [45, 48])).toBe(true);
  expect(shows([30, 60], false, [55, 65])).toBe(false);
});

test('a stretch in full takes the place of what was thinned there', () => {
  const at = (times: number[], camera?: string) => ({ ...series('speed', times.map((time) => 10 * time), camera), times });
  const [speed, other] = withStretch([at([0, 4, 8, 12]), at([0, 9], 'cam0')], [at([4, 5, 6, 7, 8]), at([], 'cam0')]);
  expect(speed!.times).toEqual([0, 4, 5, 6, 7, 8, 12]);
  expect(speed!.values).toEqual([0, 40, 50, 60, 70, 80, 120]);
  expect(other!.times).toEqual([0, 9]);
});

test('isThinned', () => {
  expect(isThinned({ series: [series('speed', [1, 2])] })).toBe(false);
  expect(isThinned({ series: [{ ...series('speed', [1, 2]), count: 3 }] })).toBe(true);
});

test('an axis has air, and sizes begin at zero', () => {
  expect(rangeOf(2, 10, true)[0]).toBe(0);
  const [low, high] = rangeOf(-1, 1, false);
  expect(low).toBeLessThan(-1);
  expect(high).toBeGreaterThan(1);
  for (const [from, to] of [rangeOf(0, 0, true), rangeOf(3, 3, false), rangeOf(null, null, true)]) expect(to).toBeGreaterThan(from);
});
