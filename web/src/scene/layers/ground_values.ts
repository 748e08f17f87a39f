// Numbers that each spot of the ground has: how sure its height is, and which drive passed there last.

import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';

import { PointGrid } from './point_grid';
import { thinned, type Track } from './track';

export type ValueAt = (x: number, y: number, z: number) => number; // NaN: unknown

const kStorey = 1.8; // [m] less than between two decks
const kSigmaReach = 2; // [m] to the nearest vertex
const kPassReach = 12; // [m] to where a drive passed: cameras map that far
const kPassSpacing = 2; // [m]

/** Of ground.ply: the sigma [m] of the nearest vertex' height, and the greatest that all but a few are below. */
export function sigmaOf(ply: ArrayBuffer): { valueAt: ValueAt; sigmas: ArrayLike<number> } {
  const loader = new PLYLoader();
  loader.setCustomPropertyNameMapping({ sigma: ['height_sigma'] });
  const geometry = loader.parse(ply);
  const sigma = geometry.getAttribute('sigma');
  if (!sigma || Number.isNaN(sigma.array[0])) throw new Error('this version was made before maps said how sure their heights are: map the site again');
  const grid = new PointGrid(geometry.getAttribute('position').array, kSigmaReach);
  const valueAt: ValueAt = (x, y, z) => {
    const nearest = grid.nearest([x, y, z], kSigmaReach, kStorey);
    return nearest < 0 ? NaN : sigma.array[nearest]!;
  };
  return { valueAt, sigmas: sigma.array };
}

/** Index of the track that passed a spot last; `tracks` may come in any order. */
export function lastPassOf(tracks: Track[]): ValueAt {
  const newestFirst = tracks
    .map((track, index) => ({
      index,
      end: Number(track.start) + (track.poses.at(-1)?.time ?? 0),
      grid: new PointGrid(thinned(track, kPassSpacing).flatMap(({ position }) => position), kPassReach),
    }))
    .sort((a, b) => b.end - a.end);
  return (x, y, z) => newestFirst.find(({ grid }) => grid.nearest([x, y, z], kPassReach, kStorey) >= 0)?.index ?? NaN;
}

const kDay = 86400; // [s]

/** [days] from each drive's end to when the map was made, or to the newest drive's end where clocks say that was later. */
export function agesOf(tracks: Track[], madeAt: string): { ages: number[]; until: number } {
  const ends = tracks.map(({ start, poses }) => Number(start) + (poses.at(-1)?.time ?? 0));
  const until = Math.max(Date.parse(madeAt) / 1000, ...ends);
  return { ages: ends.map((end) => (until - end) / kDay), until };
}
