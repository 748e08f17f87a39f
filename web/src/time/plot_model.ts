// What is plotted of a drive: the series of the service, grouped into plots, in units that people read.

import type { Plots } from '../api/types';

type Series = Plots['series'][number];

export interface PlotLine {
  label: string;
  camera: string | null;
  about: string;
  times: number[]; // [s] since the drive's start
  values: number[]; // in the plot's unit
}

export interface Plot {
  key: string;
  title: string;
  unit: string;
  digits: number;
  /** Whether no value is below zero, so that the axis begins there. */
  isSize: boolean;
  lines: PlotLine[];
}

interface Kind {
  title: string;
  unit: string;
  factor: number;
  digits: number;
  isSize: boolean;
  /** Series that share the plot, with their labels. */
  labels: Partial<Record<Series['name'], string>>;
}

const kDegrees = 180 / Math.PI;

const kKinds: Record<string, Kind> = {
  speed: { title: 'Speed', unit: 'm/s', factor: 1, digits: 2, isSize: false, labels: { speed: 'speed' } },
  inliers: { title: 'Inliers', unit: 'points', factor: 1, digits: 0, isSize: true, labels: { inliers: '' } },
  residual: { title: 'Residual', unit: 'mrad', factor: 1000, digits: 2, isSize: true, labels: { residual: '' } },
  sigma: {
    title: 'Sigma, position', unit: 'm', factor: 1, digits: 3, isSize: true,
    labels: { sigma_position: 'horizontal', sigma_height: 'height' },
  },
  yaw: { title: 'Sigma, yaw', unit: '°', factor: kDegrees, digits: 3, isSize: true, labels: { sigma_yaw: 'yaw' } },
  slip: { title: 'Wheel slip', unit: 'm/s', factor: 1, digits: 3, isSize: false, labels: { wheel_slip: 'slip' } },
  gnss: {
    title: 'GNSS', unit: 'm', factor: 1, digits: 2, isSize: true,
    labels: { gnss_error: 'off the trajectory', gnss_sigma: 'as declared' },
  },
};

/** The plots that a drive has values for, in the order in which they are read. */
export function plotsOf(plots: Pick<Plots, 'series'>): Plot[] {
  return Object.entries(kKinds).flatMap(([key, { title, unit, factor, digits, isSize, labels }]) => {
    const lines = plots.series
      .filter(({ name, values }) => name in labels && values.length > 0)
      .map(({ name, camera, about, times, values }) => ({
        label: camera ?? labels[name] ?? name,
        camera: camera ?? null,
        about,
        times,
        values: factor === 1 ? values : values.map((value) => value * factor),
      }));
    return lines.length > 0 ? [{ key, title, unit, digits, isSize, lines }] : [];
  });
}

/** How many of the first times lie at or before one. */
export function countUntil(times: ArrayLike<number>, seconds: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= seconds) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The value next to a time; null where the line has none within `reach` [s]. */
export function valueNear({ times, values }: Pick<PlotLine, 'times' | 'values'>, seconds: number, reach: number): number | null {
  const after = countUntil(times, seconds);
  const distance = (i: number) => (i >= 0 && i < times.length ? Math.abs(times[i]! - seconds) : Infinity);
  const nearest = distance(after - 1) <= distance(after) ? after - 1 : after;
  return distance(nearest) <= reach ? values[nearest]! : null;
}

export type Degraded = Plots['degraded'][number];

export const degradedAt = (stretches: readonly Degraded[], seconds: number): Degraded | null =>
  stretches.find(({ begin, end }) => begin <= seconds && seconds <= end) ?? null;

export type Window = readonly [number, number]; // [s] since the drive's start

/** A stretch of time within the drive, no shorter than what can still be told apart. */
export function windowWithin([from, to]: Window, end: number, shortest = 0.2): Window {
  const length = Math.min(end, Math.max(shortest, to - from));
  const begin = Math.min(Math.max(0, (from + to - length) / 2), end - length);
  return [begin, begin + length];
}

const kUsualPoints = 2000, kMostPoints = 20_000; // of a series, for the whole drive

/** How many points of the whole drive to ask for so that a window of it is as fine as the whole is usually. */
export function pointsFor([from, to]: Window, end: number): number {
  const share = end > 0 ? Math.max(1e-6, (to - from) / end) : 1;
  const wanted = Math.ceil(kUsualPoints / share);
  return [kUsualPoints, 3 * kUsualPoints, kMostPoints].find((points) => points >= wanted) ?? kMostPoints;
}

/** Whether the service left out values, so that asking for more brings more. */
export const isThinned = (plots: Pick<Plots, 'series'>) => plots.series.some(({ count, times }) => count > times.length);

/** What a plot's axis spans: a little air above and below; sizes begin at zero. */
export function rangeOf(low: number | null, high: number | null, isSize: boolean): [number, number] {
  if (low === null || high === null) return [0, 1];
  if (isSize && low >= 0) return [0, 1.08 * high || 1];
  const air = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low - air, high + air];
}
