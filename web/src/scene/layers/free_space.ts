// Where a car may drive, as an outline.

import type { Object3D } from 'three';

import type { Collection, FreeSpaceProperties } from '../../api/map_files';
import type { Vector } from '../../api/types';
import { kCasing, kFreeSpace } from './colors';
import { fatLines, segmentsOf } from './fat_lines';
import { polygonsOf } from './polygons';
import { simplified } from './simplify';

const kTolerance = 0.06; // [m], more than half a cell of the map
const kLift = 0.05; // [m] above the ground

/** Ends of the segments of all outlines. */
export function outlineOf(freeSpace: Collection<FreeSpaceProperties>, toSite: (position: number[]) => Vector): Vector[] {
  return freeSpace.features.flatMap(({ geometry }) =>
    polygonsOf(geometry, toSite).flatMap((rings) =>
      rings.flatMap((ring) => {
        const closed = ring.length > 0 ? [...ring, ring[0]!] : [];
        return segmentsOf(simplified(closed, kTolerance).map(([x, y, z]): Vector => [x, y, z + kLift]));
      }),
    ),
  );
}

export function makeFreeSpace(freeSpace: Collection<FreeSpaceProperties>, toSite: (position: number[]) => Vector): Object3D[] {
  const ends = outlineOf(freeSpace, toSite);
  if (ends.length === 0) return [];
  return [
    fatLines(ends, { width: 4, color: kCasing, opacity: 0.45, order: 3 }),
    fatLines(ends, { width: 2, color: kFreeSpace, order: 4 }),
  ];
}
