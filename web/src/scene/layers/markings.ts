// What is painted on the ground: lines as wide as they are, and areas such as arrows.

import * as THREE from 'three';

import type { Collection, Feature, MarkingProperties } from '../../api/map_files';
import type { Vector } from '../../api/types';
import { kMarking } from './colors';
import { polygonsOf, tintedFaces, trianglesOf } from './polygons';

const kLift = 0.03; // [m] above the ground
const kUsualWidth = 0.12; // [m]

type ToSite = (position: number[]) => Vector;

/** Points of a line; nothing where it is none. */
export const lineOf = ({ type, coordinates }: Feature<unknown>['geometry'], toSite: ToSite): Vector[] =>
  type === 'LineString' ? (coordinates as number[][]).map(toSite) : [];

/** Corners of two triangles for each segment of a line, `width` meters wide. */
export function ribbonOf(points: Vector[], width: number, lift: number): Vector[] {
  return points.slice(1).flatMap(([bx, by, bz], i) => {
    const [ax, ay, az] = points[i]!;
    const length = Math.hypot(bx - ax, by - ay);
    if (length < 1e-6) return [];
    const [dx, dy] = [((ay - by) / length) * (width / 2), ((bx - ax) / length) * (width / 2)];
    const corners: Vector[] = [
      [ax + dx, ay + dy, az + lift],
      [ax - dx, ay - dy, az + lift],
      [bx - dx, by - dy, bz + lift],
      [bx + dx, by + dy, bz + lift],
    ];
    return [0, 1, 2, 0, 2, 3].map((corner) => corners[corner]!);
  });
}

export const isPaint = ({ properties }: Feature<MarkingProperties>) => properties.type === 'line' || properties.type === 'area';

export function makeMarkings(markings: Collection<MarkingProperties>, toSite: ToSite): THREE.Object3D[] {
  const corners = markings.features.filter(isPaint).flatMap(({ properties, geometry }) => {
    const width = Number(properties['width_m'] ?? kUsualWidth);
    return [
      ...ribbonOf(lineOf(geometry, toSite), width, kLift),
      ...polygonsOf(geometry, toSite).flatMap((rings) => trianglesOf(rings, kLift)),
    ];
  });
  const color = new THREE.Color(kMarking);
  return corners.length === 0 ? [] : [tintedFaces(corners, corners.map(() => color), 0.75)];
}
