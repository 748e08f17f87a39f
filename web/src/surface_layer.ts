import * as THREE from 'three';

import type { SurfaceCollection, Vector } from './api';
import { gltfFromSite } from './pins';

/** Of what lies beside free space; what is not named is drawn as structure. */
const kColors: Record<string, number> = {
  pavement: 0xc9a2d6,
  vegetation: 0x4fa64b,
  kerb: 0xf2c230,
  vehicle: 0x3f6fe0,
  person: 0xe0554f,
  structure: 0x8a94a3,
};
const kLift = 0.02; // [m] above the ground

/** Vertices of triangles that fill a polygon; the first ring is the outer one, none repeats its first point. */
function trianglesOf(rings: Vector[][]): number[] {
  const flat = rings.map((ring) => ring.map(([x, y]) => new THREE.Vector2(x, y)));
  const points = rings.flat();
  return THREE.ShapeUtils.triangulateShape(flat[0]!, flat.slice(1)).flatMap((corners) =>
    corners.flatMap((corner) => {
      const [x, y, z] = points[corner]!;
      return gltfFromSite([x, y, z + kLift]);
    }),
  );
}

/** A tinted face for each class of `surfaces`. */
export function makeSurfaceLayer(surfaces: SurfaceCollection, toSite: (position: number[]) => Vector): THREE.Group {
  const layer = new THREE.Group();
  layer.name = 'surfaces';
  const faces = new Map<number, number[]>();
  for (const { properties, geometry } of surfaces.features) {
    const color = kColors[properties.surface] ?? kColors['structure']!;
    const rings = geometry.coordinates.map((ring) => ring.slice(0, -1).map(toSite));
    const vertices = faces.get(color) ?? [];
    for (const value of trianglesOf(rings)) vertices.push(value);
    faces.set(color, vertices);
  }
  for (const [color, vertices] of faces) {
    const material = new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.7, side: THREE.DoubleSide });
    const shape = new THREE.BufferGeometry();
    shape.setAttribute('position', new THREE.Float32BufferAttribute(vertices, 3));
    layer.add(new THREE.Mesh(shape, material));
  }
  return layer;
}
