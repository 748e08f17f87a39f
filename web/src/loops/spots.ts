// Spots of the ground that both pictures of a pair should show: where the map is right there, they show the same one.

import { Matrix4, Vector3 } from 'three';

import { request, type Schemas } from '../api/client';
import type { MapVersion, Vector } from '../api/types';

export type View = Schemas['Views']['views'][number];

const kReach = 2; // [s] from the place that a picture may be taken
const kMaxViews = 100; // that the service lists

/** Where to look for a spot: body coordinates, forward and left, [m]. */
export const kAround = [
  { name: 'Ahead', forward: 8, left: 0 },
  { name: 'Left', forward: 2, left: 5 },
  { name: 'Right', forward: 2, left: -5 },
  { name: 'Behind', forward: -6, left: 0 },
] as const;

/** A point of the ground as the car at `siteFromBody` has it. */
export const pointAround = (siteFromBody: Matrix4, forward: number, left: number): Vector =>
  new Vector3(forward, left, 0).applyMatrix4(siteFromBody).toArray();

/** The view that was taken nearest to a time; null where none was within two seconds. */
export function viewNear(views: readonly View[], time: number): View | null {
  let best: View | null = null;
  for (const view of views) {
    const off = Math.abs(Number(view.time) - time);
    if (off <= kReach && (!best || off < Math.abs(Number(best.time) - time))) best = view;
  }
  return best;
}

export async function fetchViewNear(map: MapVersion, drive: string, point: Vector, time: number): Promise<View | null> {
  const { views } = await request('get', '/api/v1/drives/{drive}/images', {
    path: { drive },
    query: { version: String(map.version), point: point.map((value) => value.toFixed(3)).join(','), limit: kMaxViews },
  });
  return viewNear(views, time);
}
