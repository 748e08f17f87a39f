// Areas of a map's GeoJSON as rings and as triangles of the site.

import * as THREE from 'three';

import type { Feature } from '../../api/map_files';
import type { Vector } from '../../api/types';
import { unpickable } from './fat_lines';

type ToSite = (position: number[]) => Vector;

/** Rings of each polygon, the outer one first; none repeats its first point. Nothing where it is no area. */
export function polygonsOf({ type, coordinates }: Feature<unknown>['geometry'], toSite: ToSite): Vector[][][] {
  const ofPolygon = (rings: number[][][]) => rings.map((ring) => ring.slice(0, -1).map(toSite));
  if (type === 'Polygon') return [ofPolygon(coordinates as number[][][])];
  return type === 'MultiPolygon' ? (coordinates as number[][][][]).map(ofPolygon) : [];
}

/** Corners of triangles that fill a polygon, `lift` meters above it. */
export function trianglesOf(rings: Vector[][], lift: number): Vector[] {
  const flat = rings.map((ring) => ring.map(([x, y]) => new THREE.Vector2(x, y)));
  const points = rings.flat();
  const outer = flat[0];
  if (!outer || outer.length < 3) return [];
  return THREE.ShapeUtils.triangulateShape(outer, flat.slice(1)).flatMap((corners) =>
    corners.map((corner): Vector => {
      const [x, y, z] = points[corner]!;
      return [x, y, z + lift];
    }),
  );
}

/** Triangles in one tinted object; `colors` has one for each corner. */
export function tintedFaces(corners: Vector[], colors: THREE.Color[], opacity: number): THREE.Mesh {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(corners.flat(), 3));
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(colors.flatMap((color) => color.toArray()), 3));
  const material = new THREE.MeshBasicMaterial({
    vertexColors: true,
    transparent: opacity < 1,
    opacity,
    side: THREE.DoubleSide,
    depthWrite: false,
  });
  const mesh = unpickable(new THREE.Mesh(geometry, material));
  mesh.renderOrder = 2;
  return mesh;
}
