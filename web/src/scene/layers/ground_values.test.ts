import { expect, test } from 'vitest';

import type { Vector } from '../../api/types';
import { agesOf, lastPassOf, sigmaOf } from './ground_values';
import { PointGrid } from './point_grid';

const track = (start: number, ...positions: Vector[]) => ({
  start: `${start}.000000000`,
  poses: positions.map((position, time) => ({ time, position, orientation: [0, 0, 0, 1] as [number, number, number, number] })),
});

test('the nearest point of a grid, on the same deck', () => {
  const grid = new PointGrid([0, 0, 0, 1.5, 0, 0, 1.1, 0, 3], 2);
  expect(grid.nearest([1.2, 0, 0], 2, 1)).toBe(1);
  expect(grid.nearest([-0.5, 0, 0], 2, 1)).toBe(0);
  expect(grid.nearest([1.2, 0, 3], 2, 1)).toBe(2);
  expect(grid.nearest([9, 9, 0], 2, 1)).toBe(-1);
});

test('the drive that came last counts where it passed', () => {
  const last = lastPassOf([track(200, [0, 0, 0.5], [30, 0, 0.5]), track(100, [0, 0, 0.5], [30, 0, 0.5], [60, 0, 0.5])]);
  expect(last(1, 5, 0)).toBe(0);
  expect(last(58, 0, 0)).toBe(1); // only the older one came here
  expect(last(58, 13, 0)).toBeNaN();
  expect(last(1, 5, 3)).toBeNaN(); // the deck above
});

test('ages count to when the map was made, or to the newest drive where clocks say that was later', () => {
  const day = 86400;
  const tracks = [track(10 * day, [0, 0, 0]), track(13 * day, [0, 0, 0])];
  expect(agesOf(tracks, '1970-01-15T00:00:00Z')).toEqual({ ages: [4, 1], until: 14 * day });
  expect(agesOf(tracks, '1970-01-02T00:00:00Z')).toEqual({ ages: [3, 0], until: 13 * day });
});

function plyOf(properties: string[], vertices: number[][]): ArrayBuffer {
  const header = `ply\nformat binary_little_endian 1.0\nelement vertex ${vertices.length}\n${properties.map((name) => `property float ${name}\n`).join('')}end_header\n`;
  const bytes = new Uint8Array(header.length + 4 * vertices.flat().length);
  bytes.set(new TextEncoder().encode(header));
  const view = new DataView(bytes.buffer);
  vertices.flat().forEach((value, i) => view.setFloat32(header.length + 4 * i, value, true));
  return bytes.buffer;
}

test('each spot has the sigma of the vertex next to it', () => {
  const { valueAt } = sigmaOf(plyOf(['x', 'y', 'z', 'height_sigma'], [[0, 0, 0, 0.01], [3, 0, 0, 0.02]]));
  expect(valueAt(0.4, 0, 0)).toBeCloseTo(0.01);
  expect(valueAt(2.4, 0, 0.1)).toBeCloseTo(0.02);
  expect(valueAt(40, 0, 0)).toBeNaN();
  expect(() => sigmaOf(plyOf(['x', 'y', 'z'], [[0, 0, 0]]))).toThrow('map the site again');
});
