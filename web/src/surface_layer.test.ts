import * as THREE from 'three';
import { expect, test } from 'vitest';

import type { SurfaceCollection, Vector } from './api';
import { makeSurfaceLayer } from './surface_layer';

const square = (low: number, high: number): number[][] =>
  [[low, low, 1], [high, low, 1], [high, high, 1], [low, high, 1], [low, low, 1]];

const asTheyAre = (position: number[]) => position as Vector;

function areaOf(mesh: THREE.Mesh): number {
  const place = mesh.geometry.getAttribute('position');
  let area = 0;
  const [a, b, c] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
  for (let i = 0; i < place.count; i += 3) {
    [a, b, c].forEach((corner, k) => corner.fromBufferAttribute(place, i + k));
    area += b.sub(a).cross(c.sub(a)).length() / 2;
  }
  return area;
}

test('a class is one mesh, holes are left open', () => {
  const surfaces: SurfaceCollection = {
    features: [
      { properties: { surface: 'pavement', level: 0, area_m2: 12 }, geometry: { coordinates: [square(0, 4), square(1, 3)] } },
      { properties: { surface: 'pavement', level: 0, area_m2: 1 }, geometry: { coordinates: [square(9, 10)] } },
      { properties: { surface: 'kerb', level: 0, area_m2: 1 }, geometry: { coordinates: [square(20, 21)] } },
    ],
  };
  const layer = makeSurfaceLayer(surfaces, asTheyAre);

  expect(layer.children.map((mesh) => areaOf(mesh as THREE.Mesh))).toEqual([13, 1]);
  const box = new THREE.Box3().setFromObject(layer);
  expect([box.min.x, box.max.x, box.min.z]).toEqual([0, 21, -21]);
  expect(box.min.y).toBeGreaterThan(1);
});
