// What stands out of the ground: kerbs as low walls, speed bumps as plates across the way over them.

import * as THREE from 'three';

import type { Collection, Feature, MarkingProperties } from '../../api/map_files';
import type { Vector } from '../../api/types';
import { kCasing, kKerb, kSpeedBump } from './colors';
import { fatLines, segmentsOf } from './fat_lines';
import { lineOf } from './markings';
import { tintedFaces } from './polygons';

const kBumpWidth = 3; // [m] across the way: a lane's; the map does not say
const kLift = 0.03; // [m] above the ground

type ToSite = (position: number[]) => Vector;

export const isKerb = ({ properties }: Feature<MarkingProperties>) => properties.type === 'kerb';
export const isSpeedBump = ({ properties }: Feature<MarkingProperties>) => properties.type === 'speed_bump';

/** Corners of a speed bump's plate: `length` along the way, `yaw` [degrees] counter-clockwise from x. */
export function plateOf([x, y, z]: Vector, yaw: number, length: number): Vector[] {
  const [cos, sin] = [Math.cos((yaw * Math.PI) / 180), Math.sin((yaw * Math.PI) / 180)];
  const at = (along: number, across: number): Vector => [x + cos * along - sin * across, y + sin * along + cos * across, z + kLift];
  const [a, b] = [length / 2, kBumpWidth / 2];
  return [at(-a, -b), at(a, -b), at(a, b), at(-a, b)];
}

export function makeKerbs(markings: Collection<MarkingProperties>, toSite: ToSite): THREE.Object3D[] {
  const tops: Vector[] = [];
  const [faces, colors]: [Vector[], THREE.Color[]] = [[], []];
  const addFace = (corners: Vector[], color: number) => {
    for (const corner of [0, 1, 2, 0, 2, 3]) {
      faces.push(corners[corner]!);
      colors.push(new THREE.Color(color));
    }
  };
  for (const { properties, geometry } of markings.features.filter(isKerb)) {
    const height = Number(properties['height_m'] ?? 0);
    const line = segmentsOf(lineOf(geometry, toSite));
    for (let i = 0; i < line.length; i += 2) {
      const foot = [line[i]!, line[i + 1]!];
      const top = foot.map(([x, y, z]): Vector => [x, y, z + height + kLift]);
      tops.push(...top);
      addFace([foot[0]!, foot[1]!, top[1]!, top[0]!], kKerb);
    }
  }
  for (const { properties, geometry } of markings.features.filter(isSpeedBump)) {
    if (geometry.type !== 'Point') continue;
    const [x, y, z] = toSite(geometry.coordinates as number[]);
    const height = Number(properties['height_m'] ?? 0);
    addFace(plateOf([x, y, z + height], Number(properties['yaw_deg'] ?? 0), Number(properties['length_m'] ?? 0.5)), kSpeedBump);
  }
  const lines =
    tops.length === 0
      ? []
      : [fatLines(tops, { width: 6, color: kCasing, opacity: 0.5, order: 3 }), fatLines(tops, { width: 3, color: kKerb, order: 4 })];
  return faces.length === 0 ? lines : [tintedFaces(faces, colors, 0.85), ...lines];
}
