import * as THREE from 'three';
import { expect, test } from 'vitest';

import type { Plots } from '../../api/types';
import { kUnknown } from './colors';
import { colorWays, makeTrajectories } from './trajectories';

const track = {
  start: '100.000000000',
  poses: [0, 1, 2].map((time) => ({ time, position: [time, 0, 0] as [number, number, number], orientation: [0, 0, 0, 1] as [number, number, number, number] })),
};
const plots = { start: '101.000000000', series: [{ name: 'speed', unit: 'm/s', about: '', count: 2, times: [0, 1], values: [-4, 2] }] } as unknown as Plots;
const hex = (color: THREE.Color | undefined) => color?.getHex();

test('each drive has its color', () => {
  const { ends, colors } = colorWays([{ track, color: 0x39a0ff, plots: null }], 'drive');
  expect(ends).toEqual([[0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]]);
  expect(colors.map(hex)).toEqual([0x39a0ff, 0x39a0ff, 0x39a0ff, 0x39a0ff]);
});

test('numbers count from the start of the plots, and a speed backward is one', () => {
  const { colors, high } = colorWays([{ track, color: 0, plots }], 'speed');
  expect(high).toBe(5); // of 4 m/s
  expect(hex(colors[3])).not.toBe(hex(colors[2])); // 2 m/s, 4 m/s
  expect(hex(colorWays([{ track, color: 0, plots }], 'residual').colors[0])).toBe(kUnknown);
});

test('all drives are two objects, none are none', () => {
  expect(makeTrajectories([{ track, color: 1, plots: null }, { track, color: 2, plots: null }], 'drive').objects).toHaveLength(2);
  expect(makeTrajectories([], 'drive').objects).toHaveLength(0);
});
