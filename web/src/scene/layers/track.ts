// A drive's way as the map has it: where the car was at a time, and numbers along it.

import type { Plots, Vector } from '../../api/types';
import type { TrajectoryPose } from '../../api/map_files';
import { secondsBetween } from '../../api/map_files';

export interface Track {
  start: string; // [s] on the drive's clock, as decimal text
  poses: TrajectoryPose[]; // times since then
}

/** Index of the last pose that is not after a time; -1 before the first. */
function lastBefore(poses: TrajectoryPose[], time: number): number {
  let [low, high] = [0, poses.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (poses[middle]!.time <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** Where the car was, [m] in site; null where the track does not say. */
export function placeAt({ poses }: Track, time: number): Vector | null {
  const [first, last] = [poses[0], poses.at(-1)];
  if (!first || !last || time < first.time - kSlack || time > last.time + kSlack) return null;
  const before = poses[Math.max(0, lastBefore(poses, time))]!;
  const after = poses[Math.min(poses.length - 1, lastBefore(poses, time) + 1)]!;
  const share = after.time > before.time ? Math.min(Math.max((time - before.time) / (after.time - before.time), 0), 1) : 0;
  return before.position.map((value, axis) => value + share * (after.position[axis]! - value)) as Vector;
}
const kSlack = 0.5; // [s] that a time may lie outside a track

/** Poses that are `spacing` [m] apart at least, and the first and the last. */
export function thinned({ poses }: Track, spacing: number): TrajectoryPose[] {
  const kept: TrajectoryPose[] = [];
  for (const pose of poses) {
    const last = kept.at(-1);
    if (last && pose !== poses.at(-1) && Math.hypot(...pose.position.map((value, axis) => value - last.position[axis]!)) < spacing) continue;
    kept.push(pose);
  }
  return kept;
}

/** Times of a drive's plots less times of its track, [s]. */
export const plotOffset = (track: Track, plots: Plots) => secondsBetween(track.start, plots.start);

type Series = Plots['series'][number];

/** The number of a series at a time, between its samples; null where none lies within `reach` [s]. */
export function valueAt({ times, values }: Pick<Series, 'times' | 'values'>, time: number, reach: number): number | null {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= time) low = middle + 1;
    else high = middle;
  }
  const [before, after] = [low - 1, Math.min(low, times.length - 1)];
  if (before < 0) return times.length > 0 && times[0]! - time <= reach ? values[0]! : null;
  const [past, coming] = [time - times[before]!, times[after]! - time];
  if (past > reach && (coming > reach || after === before)) return null;
  if (after === before || coming <= 0 || past + coming > 2 * reach) return past <= coming || after === before ? values[before]! : values[after]!;
  return values[before]! + (past / (past + coming)) * (values[after]! - values[before]!);
}
