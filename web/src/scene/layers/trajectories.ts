// The ways of all drives in one object, in a color for each drive or by a number along them.

import * as THREE from 'three';

import type { Plots, Vector } from '../../api/types';
import { rampColor } from '../ground_look';
import { kCasing, kUnknown } from './colors';
import { fatLines, segmentsOf } from './fat_lines';
import { kQuantities, niceEnd, quantityAt, type PathColor } from './path_colors';
import { plotOffset, thinned, type Track } from './track';

const kSpacing = 0.25; // [m] between points that are drawn

export interface DriveWay {
  track: Track;
  color: number;
  plots: Plots | null; // null: colors by drive only
}

/** Ends of segments, their colors, and where the ramp of these ends. */
export function colorWays(ways: DriveWay[], by: PathColor): { ends: Vector[]; colors: THREE.Color[]; high: number } {
  const points = ways.map(({ track, plots }) =>
    thinned(track, kSpacing).map(({ position, time }) => ({
      position,
      value: by === 'drive' || !plots ? null : quantityAt(plots, kQuantities[by], time - plotOffset(track, plots)),
    })),
  );
  const high = niceEnd(points.flat().flatMap(({ value }) => (value === null ? [] : [value])));
  const colored = points.map((way, i) =>
    way.map(({ position, value }) => ({
      position,
      color: by === 'drive' ? new THREE.Color(ways[i]!.color) : value === null ? new THREE.Color(kUnknown) : rampColor(value / high),
    })),
  );
  const segments = colored.flatMap((way) => segmentsOf(way));
  return { ends: segments.map(({ position }) => position), colors: segments.map(({ color }) => color), high };
}

export function makeTrajectories(ways: DriveWay[], by: PathColor): { objects: THREE.Object3D[]; high: number } {
  const { ends, colors, high } = colorWays(ways, by);
  if (ends.length === 0) return { objects: [], high };
  return {
    objects: [
      fatLines(ends, { width: 6, color: kCasing, opacity: 0.5, order: 3 }),
      fatLines(ends, { width: 3, colors, order: 4 }),
    ],
    high,
  };
}
