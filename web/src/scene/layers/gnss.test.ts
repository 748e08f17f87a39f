import { expect, test } from 'vitest';

import type { Plots } from '../../api/types';
import { makeFixRings, ringsOf } from './gnss';

const track = {
  start: '100.000000000',
  poses: [0, 10].map((time) => ({ time, position: [time, 0, 0] as [number, number, number], orientation: [0, 0, 0, 1] as [number, number, number, number] })),
};

test('a ring lies where the car was, as wide as the fix is off', () => {
  const plots = {
    start: '101.000000000',
    series: [
      { name: 'gnss_error', times: [2, 500], values: [0.7, 1] },
      { name: 'speed', times: [2], values: [9] },
    ],
  } as unknown as Plots;
  const rings = ringsOf(track, plots);
  expect(rings).toHaveLength(1); // the drive was over at the second
  expect(rings[0]!.center[0]).toBeCloseTo(3);
  expect(rings[0]!.radius).toBe(0.7);
  const { objects, high } = makeFixRings(rings);
  expect(objects).toHaveLength(2);
  expect(high).toBe(0.8);
  expect(makeFixRings([]).objects).toHaveLength(0);
});
