// How far each GNSS fix lies off the way, as a ring of that radius about where the car was: for maps of
// before, which do not say where the fixes lie (fixes.ts).

import * as THREE from 'three';

import type { Plots, Vector } from '../../api/types';
import { rampColor } from '../ground_look';
import { kCasing } from './colors';
import { fatLines } from './fat_lines';
import { niceEnd } from './path_colors';
import { placeAt, plotOffset, type Track } from './track';

const kSides = 24;

export interface FixRing {
  center: Vector;
  radius: number; // [m]
}

export function ringsOf(track: Track, plots: Plots): FixRing[] {
  const offset = plotOffset(track, plots);
  return plots.series
    .filter(({ name }) => name === 'gnss_error')
    .flatMap(({ times, values }) =>
      times.flatMap((time, i) => {
        const center = placeAt(track, time + offset);
        return center ? [{ center, radius: values[i]! }] : [];
      }),
    );
}

export function makeFixRings(rings: FixRing[]): { objects: THREE.Object3D[]; high: number } {
  const high = niceEnd(rings.map(({ radius }) => radius));
  const [ends, colors]: [Vector[], THREE.Color[]] = [[], []];
  for (const { center: [x, y, z], radius } of rings) {
    const color = rampColor(radius / high);
    const at = (side: number): Vector => {
      const angle = (2 * Math.PI * side) / kSides;
      return [x + radius * Math.cos(angle), y + radius * Math.sin(angle), z];
    };
    for (let side = 0; side < kSides; ++side) {
      ends.push(at(side), at(side + 1));
      colors.push(color, color);
    }
  }
  if (ends.length === 0) return { objects: [], high };
  return {
    objects: [fatLines(ends, { width: 3.5, color: kCasing, opacity: 0.3, order: 3 }), fatLines(ends, { width: 1.5, colors, order: 4 })],
    high,
  };
}
