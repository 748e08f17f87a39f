// What lies beside free space, by class: pavement, vegetation, cars that stand there ...

import * as THREE from 'three';

import type { Collection, SurfaceProperties } from '../../api/map_files';
import type { Vector } from '../../api/types';
import { kSurfaceColors } from './colors';
import { polygonsOf, tintedFaces, trianglesOf } from './polygons';

const kLift = 0.02; // [m] above the ground

export const surfaceColor = (surface: string) => kSurfaceColors[surface] ?? kSurfaceColors['structure']!;

/** [m²] of each class, the largest first. */
export function areasOf(surfaces: Collection<SurfaceProperties>): [surface: string, area: number][] {
  const areas = new Map<string, number>();
  for (const { properties } of surfaces.features)
    areas.set(properties.surface, (areas.get(properties.surface) ?? 0) + properties.area_m2);
  return [...areas].sort((a, b) => b[1] - a[1]);
}

export function makeSurfaces(surfaces: Collection<SurfaceProperties>, toSite: (position: number[]) => Vector): THREE.Object3D[] {
  const [corners, colors]: [Vector[], THREE.Color[]] = [[], []];
  for (const { properties, geometry } of surfaces.features) {
    const color = new THREE.Color(surfaceColor(properties.surface));
    for (const rings of polygonsOf(geometry, toSite))
      for (const corner of trianglesOf(rings, kLift)) {
        corners.push(corner);
        colors.push(color);
      }
  }
  return corners.length === 0 ? [] : [tintedFaces(corners, colors, 0.55)];
}
