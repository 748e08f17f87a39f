import { expect, test } from 'vitest';

import type { Feature, MarkingProperties, SlotProperties } from '../../api/map_files';
import type { Vector } from '../../api/types';
import { makeFreeSpace, outlineOf } from './free_space';
import { isKerb, isSpeedBump, makeKerbs, plateOf } from './kerbs';
import { isPaint, makeMarkings, ribbonOf } from './markings';
import { polygonsOf, trianglesOf } from './polygons';
import { simplified } from './simplify';
import { centerOf, isSlotPick, makeSlotFrame, makeSlots } from './slots';
import { areasOf, makeSurfaces, surfaceColor } from './surfaces';

const asItIs = ([x, y, z]: number[]): Vector => [x!, y!, z ?? 0];
const square = (size: number): number[][] => [[0, 0, 1], [size, 0, 1], [size, size, 1], [0, size, 1], [0, 0, 1]];
const areaOf = (corners: Vector[]) => {
  let area = 0;
  for (let i = 0; i < corners.length; i += 3) {
    const [[ax, ay], [bx, by], [cx, cy]] = [corners[i]!, corners[i + 1]!, corners[i + 2]!];
    area += Math.abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2;
  }
  return area;
};

test('polygons lose the point that closes them, holes stay open', () => {
  const hole = [[1, 1, 1], [2, 1, 1], [2, 2, 1], [1, 2, 1], [1, 1, 1]];
  const [rings] = polygonsOf({ type: 'Polygon', coordinates: [square(4), hole] }, asItIs);
  expect(rings!.map((ring) => ring.length)).toEqual([4, 4]);
  const triangles = trianglesOf(rings!, 0.5);
  expect(areaOf(triangles)).toBeCloseTo(15);
  expect(triangles[0]![2]).toBe(1.5);
  expect(polygonsOf({ type: 'MultiPolygon', coordinates: [[square(1)], [square(2)]] }, asItIs)).toHaveLength(2);
  expect(polygonsOf({ type: 'LineString', coordinates: [[0, 0], [1, 1]] }, asItIs)).toEqual([]);
});

test('steps of cells become a line, corners stay', () => {
  const stairs = Array.from({ length: 41 }, (_, i): Vector => [0.05 * Math.ceil(i / 2), 0.05 * Math.floor(i / 2), 0]);
  expect(simplified(stairs, 0.06)).toHaveLength(2);
  expect(simplified([[0, 0, 0], [5, 0, 0], [5, 5, 0]], 0.06)).toHaveLength(3);
});

test('the outline of free space is closed', () => {
  const freeSpace = { features: [{ properties: { level: 0, area_m2: 9, min_height_m: 0, max_height_m: 0, mean_height_m: 0 }, geometry: { type: 'Polygon' as const, coordinates: [square(3)] } }] };
  const ends = outlineOf(freeSpace, asItIs);
  expect(ends).toHaveLength(8);
  expect(ends[0]).toEqual(ends.at(-1));
  expect(makeFreeSpace(freeSpace, asItIs)).toHaveLength(2);
  expect(makeFreeSpace({ features: [] }, asItIs)).toHaveLength(0);
});

const slot = (id: string, state: SlotProperties['state'], corners_m = square(2).slice(0, 4) as Vector[]): Feature<SlotProperties> => ({
  properties: { id, state, corners_m, type: 'perpendicular', states: {}, level: 0, confidence: 1, width_m: 2, length_m: 2 },
  geometry: { type: 'Polygon', coordinates: [] },
});

test('a slot can be chosen, and is drawn in few objects however many there are', () => {
  const slots = { features: [slot('a', 'free'), slot('b', 'occupied'), slot('broken', 'free', [])] };
  const objects = makeSlots(slots);
  const picks = objects.map(({ userData }) => userData['pick'] as unknown).filter(isSlotPick);
  expect(picks.map(({ id }) => id)).toEqual(['a', 'b']);
  expect(objects.length - picks.length).toBe(3);
  expect(isSlotPick(undefined)).toBe(false);
  expect(isSlotPick({ kind: 'comment', id: 'x' })).toBe(false);
  expect(centerOf(slots.features[0]!.properties.corners_m)).toEqual([1, 1, 1]);
  expect(makeSlotFrame(slots.features[0]!.properties)).toHaveLength(2);
  expect(makeSlots({ features: [] })).toHaveLength(0);
});

const marking = (type: string, geometry: Feature<unknown>['geometry'], more = {}): Feature<MarkingProperties> => ({
  properties: { type, level: 0, ...more }, geometry,
});

test('a painted line is as wide as it is', () => {
  const ribbon = ribbonOf([[0, 0, 0], [4, 0, 0], [4, 0, 0]], 0.2, 0.03);
  expect(areaOf(ribbon)).toBeCloseTo(0.8); // a segment of no length has no sides
  expect(ribbon[0]).toEqual([0, 0.1, 0.03]);
});

test('paint, kerbs and bumps are told apart', () => {
  const markings = { features: [
    marking('line', { type: 'LineString', coordinates: [[0, 0, 0], [1, 0, 0]] }, { width_m: 0.1 }),
    marking('area', { type: 'Polygon', coordinates: [square(1)] }),
    marking('kerb', { type: 'LineString', coordinates: [[0, 5, 0], [9, 5, 0]] }, { height_m: 0.12 }),
    marking('speed_bump', { type: 'Point', coordinates: [3, 3, 0] }, { height_m: 0.05, length_m: 0.6, yaw_deg: 90 }),
  ] };
  expect(markings.features.map((feature) => [isPaint, isKerb, isSpeedBump].map((is) => is(feature)))).toEqual([
    [true, false, false], [true, false, false], [false, true, false], [false, false, true],
  ]);
  expect(makeMarkings(markings, asItIs)).toHaveLength(1);
  expect(makeKerbs(markings, asItIs)).toHaveLength(3);
  expect(makeMarkings({ features: markings.features.slice(2) }, asItIs)).toHaveLength(0);
  expect(makeKerbs({ features: markings.features.slice(0, 2) }, asItIs)).toHaveLength(0);
});

test('a bump lies across the way over it', () => {
  const plate = plateOf([10, 20, 0], 90, 0.6); // the way leads north
  const extent = (axis: 0 | 1) => Math.max(...plate.map((corner) => corner[axis])) - Math.min(...plate.map((corner) => corner[axis]));
  expect(extent(0)).toBeCloseTo(3);
  expect(extent(1)).toBeCloseTo(0.6);
});

test('surfaces add up by class; one that is not known is drawn as structure', () => {
  const surface = (name: string, area_m2: number) => ({
    properties: { surface: name, level: 0, area_m2 }, geometry: { type: 'Polygon' as const, coordinates: [square(2)] },
  });
  const surfaces = { features: [surface('pavement', 4), surface('vegetation', 9), surface('pavement', 8)] };
  expect(areasOf(surfaces)).toEqual([['pavement', 12], ['vegetation', 9]]);
  expect(makeSurfaces(surfaces, asItIs)).toHaveLength(1);
  expect(makeSurfaces({ features: [] }, asItIs)).toHaveLength(0);
  expect(surfaceColor('marble')).toBe(surfaceColor('structure'));
});
