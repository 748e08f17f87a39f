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

/** The stretch to ask for where a window is to be seen in full: it may be moved by its own length either way. */
export function widened([from, to]: Window, end: number): Window {
  const length = to - from;
  return [Math.max(0, from - length), Math.min(end, to + length)];
}

const kNarrower = 3; // times, from which on a window of a thinned stretch is asked for by itself

/** Whether a stretch of plots shows a window as finely as can be. */
export function shows(stretch: Window, isThin: boolean, [from, to]: Window): boolean {
  const isWithin = stretch[0] <= from && to <= stretch[1];
  return isWithin && (!isThin || stretch[1] - stretch[0] <= kNarrower * (to - from) * (1 + 1e-9));
}

/** The series of a whole drive with a stretch of them in full. */
export function withStretch(whole: readonly Series[], stretch: readonly Series[]): Series[] {
  return whole.map((series) => {
    const full = stretch.find(({ name, camera }) => name === series.name && camera === series.camera);
    const [first, last] = [full?.times[0], full?.times.at(-1)];
    if (!full || first === undefined || last === undefined) return series;
    const before = countUntil(series.times, first - kTick);
    const after = countUntil(series.times, last);
    const joined = (all: readonly number[], fine: readonly number[]) => [...all.slice(0, before), ...fine, ...all.slice(after)];
    return { ...series, times: joined(series.times, full.times), values: joined(series.values, full.values) };
  });
}
const kTick = 5e-5; // [s] half of the steps that the service rounds times to

/** Whether the service left out values, so that asking for more brings more. */
export const isThinned = (plots: Pick<Plots, 'series'>) => plots.series.some(({ count, times }) => count > times.length);

/** What a plot's axis spans: a little air above and below; sizes begin at zero. */
export function rangeOf(low: number | null, high: number | null, isSize: boolean): [number, number] {
  if (low === null || high === null) return [0, 1];
  if (isSize && low >= 0) return [0, 1.08 * high || 1];
  const air = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low - air, high + air];
}
