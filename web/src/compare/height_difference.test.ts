import { BufferAttribute, BufferGeometry, Matrix4, type BufferGeometry as Geometry } from 'three';
import { expect, test } from 'vitest';

import { laterFromEarlier } from './alignment';
import { colorByDifference, differenceOf, EarlierHeights, rangeOf, refined } from './height_difference';

/** A square of `side` meters in two triangles at a height. */
function square(side: number, height: number): Geometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array([0, 0, height, side, 0, height, side, side, height, 0, side, height]), 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  return geometry;
}

function areaOf({ positions, index }: { positions: Float32Array; index: Uint32Array }): number {
  let area = 0;
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [3 * index[t]!, 3 * index[t + 1]!, 3 * index[t + 2]!];
    area += ((positions[b]! - positions[a]!) * (positions[c + 1]! - positions[a + 1]!) - (positions[c]! - positions[a]!) * (positions[b + 1]! - positions[a + 1]!)) / 2;
  }
  return area;
}

test('a refined surface is the same surface, the same way up', () => {
  const { array } = square(4, 1).getAttribute('position');
  const fine = refined(array, [0, 1, 2, 0, 2, 3], 0.5);
  expect(areaOf(fine)).toBeCloseTo(16, 4);
  const edges = new Map<string, number>(); // of how many triangles
  for (let t = 0; t < fine.index.length; t += 3)
    for (let i = 0; i < 3; ++i) {
      const [a, b] = [fine.index[t + i]!, fine.index[t + ((i + 1) % 3)]!];
      const length = Math.hypot(...[0, 1, 2].map((axis) => fine.positions[3 * a + axis]! - fine.positions[3 * b + axis]!));
      expect(length).toBeLessThanOrEqual(0.5 + 1e-6);
      const name = [Math.min(a, b), Math.max(a, b)].join(' ');
      edges.set(name, (edges.get(name) ?? 0) + 1);
    }
  const alone = [...edges].filter(([, count]) => count === 1).map(([name]) => name.split(' ').map(Number));
  const isAtRim = (point: number) => [0, 1].some((axis) => [0, 4].includes(fine.positions[3 * point + axis]!));
  expect(alone.every((ends) => ends.every(isAtRim))).toBe(true); // no gaps within
});

test('long edges are halved whichever side of a triangle they are', () => {
  for (const corners of [[0, 0, 0, 3, 0, 0, 0, 1, 0], [3, 0, 0, 0, 1, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0, 3, 0, 0]])
    for (const step of [0.3, 1.2, 2, 3.1]) expect(areaOf(refined(corners, [0, 1, 2], step))).toBeCloseTo(1.5, 5);
});

test('a surface too large to draw finely is refined less', () => {
  const fine = refined(square(400, 0).getAttribute('position').array, [0, 1, 2, 0, 2, 3], 0.3, 10_000);
  expect(fine.index.length / 3).toBeLessThanOrEqual(10_000);
  expect(fine.index.length / 3).toBeGreaterThan(2000);
});

test('a bump between the later ground\'s corners is seen', async () => {
  const earlier = square(4, 0);
  const bump = new Float32Array([...earlier.getAttribute('position').array, 2, 1, 0.2]);
  earlier.setAttribute('position', new BufferAttribute(bump, 3));
  earlier.setIndex([0, 1, 4, 1, 2, 4, 2, 0, 4, 0, 2, 3]);
  const found = await differenceOf(square(4, 0), new EarlierHeights(earlier, new Matrix4()), () => true);
  const differences = Array.from(found!.getAttribute('difference').array);
  expect(Math.min(...differences)).toBeLessThan(-0.17);
  expect(rangeOf(differences, 1)).toBeLessThan(0.21);
});

test('the alignment counts, other decks and what was not mapped do not', () => {
  const heights = new EarlierHeights(square(10, 0), laterFromEarlier({ translation: [100, 0, 2], yaw_deg: 90 }));
  expect(heights.above(95, 5, 2.05)).toBeCloseTo(0.05, 5);
  expect(heights.above(95, 5, 1.9)).toBeCloseTo(-0.1, 5);
  expect(heights.above(95, 5, 5)).toBeNaN(); // a deck above
  expect(heights.above(105, 5, 2)).toBeNaN(); // beside it
});

test('colors say the sign, and gray what is not known', () => {
  const geometry = new BufferGeometry();
  geometry.setAttribute('difference', new BufferAttribute(new Float32Array([-1, 0, 1, NaN]), 1));
  colorByDifference(geometry, 0.1);
  const color = (i: number) => Array.from(geometry.getAttribute('color').array.slice(3 * i, 3 * i + 3));
  expect(color(0)[2]).toBeGreaterThan(color(0)[0]!); // blue
  expect(color(2)[0]).toBeGreaterThan(color(2)[2]!); // red
  expect(Math.min(...color(1))).toBeGreaterThan(200);
  expect(new Set(color(3)).size).toBe(1);
  expect(rangeOf([NaN], 0.95)).toBe(0);
});
