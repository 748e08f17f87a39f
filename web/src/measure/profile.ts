// The ground's height along a line.

import type { Vector } from '../api/types';
import { runOf } from './geometry';

export interface Station {
  along: number; // [m] from the line's first point, seen from above
  point: Vector; // its height is the ground's
  isGround: boolean; // whether there is ground; else the height is that of the line
}

const kMostStations = 400;
const kFinest = 0.05; // [m] the map's cells

/** Places along a line, as far apart as `step` or what the number of stations allows: [m] from the beginning, and the point. */
export function placesAlong(line: Vector[], step: number): { along: number; point: Vector }[] {
  const length = runOf(line);
  if (line.length < 2 || length === 0) return [];
  const count = Math.ceil(length / step - 1e-9);
  const places: { along: number; point: Vector }[] = [];
  let [leg, legStart] = [0, 0];
  for (let i = 0; i <= count; ++i) {
    const along = Math.min(length, (i * length) / count);
    let legLength = runOf(line.slice(leg, leg + 2));
    while (along > legStart + legLength && leg < line.length - 2) {
      legStart += legLength;
      leg += 1;
      legLength = runOf(line.slice(leg, leg + 2));
    }
    const share = legLength === 0 ? 0 : Math.min(1, (along - legStart) / legLength);
    const [from, to] = [line[leg]!, line[leg + 1]!];
    places.push({ along, point: from.map((value, axis) => value + share * (to[axis]! - value)) as Vector });
  }
  return places;
}

/**
 * The ground under a line. It is looked for where it was a step before: of several decks it is the one that the
 * line was drawn on. `groundAt` is given where to look, and about how high.
 */
export function profileOf(line: Vector[], groundAt: (x: number, y: number, height: number) => number | null): Station[] {
  let last: number | null = null;
  return placesAlong(line, Math.max(kFinest, runOf(line) / kMostStations)).map(({ along, point: [x, y, z] }) => {
    const ground: number | null = (last === null ? null : groundAt(x, y, last)) ?? groundAt(x, y, z);
    last = ground;
    return { along, point: [x, y, ground ?? z], isGround: ground !== null };
  });
}

export interface Summary {
  low: number; // [m]
  high: number;
  rise: number; // of the last above the first
  steepest: number; // percent, over a wheelbase
}

const kWheelbase = 2.5; // [m] shorter bumps are no slope

/** Null where there is no ground below the line. */
export function summaryOf(profile: Station[]): Summary | null {
  const ground = profile.filter(({ isGround }) => isGround);
  const heights = ground.map(({ point }) => point[2]);
  if (ground.length < 2) return null;
  return {
    low: Math.min(...heights),
    high: Math.max(...heights),
    rise: heights.at(-1)! - heights[0]!,
    steepest: steepestOf(ground),
  };
}

function steepestOf(ground: Station[]): number {
  const reach = Math.min(kWheelbase, ground.at(-1)!.along - ground[0]!.along);
  let [steepest, from] = [0, 0];
  for (const to of ground) {
    while (ground[from + 1] && to.along - ground[from + 1]!.along >= reach - 1e-9) from += 1;
    const run = to.along - ground[from]!.along;
    if (run < reach - 1e-9) continue;
    const slope = (100 * (to.point[2] - ground[from]!.point[2])) / run;
    if (Math.abs(slope) > Math.abs(steepest)) steepest = slope;
  }
  return steepest;
}

/** One line for each station; `place` gives [longitude, latitude, height], or nothing where the map is not on Earth. */
export function profileCsv(profile: Station[], place: ((point: Vector) => number[]) | null): string {
  const rows = profile.map(({ along, point, isGround }) => {
    const [x, y, z] = point;
    const onEarth = place?.(point);
    return [
      along.toFixed(3),
      x.toFixed(3),
      y.toFixed(3),
      isGround ? z.toFixed(3) : '',
      ...(onEarth ? [onEarth[1]!.toFixed(9), onEarth[0]!.toFixed(9), isGround ? onEarth[2]!.toFixed(3) : ''] : []),
    ].join(',');
  });
  const head = ['along_m', 'x_m', 'y_m', 'ground_m', ...(place ? ['latitude', 'longitude', 'height_m'] : [])].join(',');
  return [head, ...rows].join('\r\n') + '\r\n';
}
