import * as THREE from 'three';
import { expect, test } from 'vitest';

import { colorsByHeight, rampColor } from './height_colors';

function geometryWithHeights(heights: number[]): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  const positions = heights.flatMap((height) => [0, height, 0]);
  return geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions), 3));
}

test('lowest and highest vertex get the ends of the ramp', () => {
  const colors = colorsByHeight(geometryWithHeights([2, 0, 1]));

  expect(colors.getX(1)).toBeCloseTo(rampColor(0).r);
  expect(colors.getX(0)).toBeCloseTo(rampColor(1).r);
});

test('millimeters of noise on a flat lot stay one color', () => {
  const colors = colorsByHeight(geometryWithHeights([0, 0.001]));

  expect(Math.abs(colors.getY(0) - colors.getY(1))).toBeLessThan(0.02);
});

test('fractions outside [0, 1] are clamped', () => {
  expect(rampColor(-1).equals(rampColor(0))).toBe(true);
  expect(rampColor(2).equals(rampColor(1))).toBe(true);
});
