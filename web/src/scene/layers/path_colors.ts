// What the color of a drive's way stands for.

import type { Plots } from '../../api/types';
import { valueAt } from './track';

export const kPathColors = ['drive', 'residual', 'speed', 'sigma', 'gnss'] as const;
export type PathColor = (typeof kPathColors)[number];

type SeriesName = Plots['series'][number]['name'];

interface Quantity {
  title: string;
  about: string;
  unit: string;
  series: SeriesName;
  scale: number; // from the series' unit to this one
  reach: number; // [s] that a sample holds for
}

export const kQuantities: Record<Exclude<PathColor, 'drive'>, Quantity> = {
  residual: {
    title: 'Residual', about: 'of tracked points, in the worst camera', unit: 'mrad', series: 'residual', scale: 1000, reach: 1.5,
  },
  speed: { title: 'Speed', about: 'forward or backward', unit: 'm/s', series: 'speed', scale: 1, reach: 1 },
  sigma: { title: 'Sigma of position', about: 'since the first pose of the drive', unit: 'm', series: 'sigma_position', scale: 1, reach: 5 },
  gnss: { title: 'GNSS error', about: 'of the fixes off the way; gray: no fix', unit: 'm', series: 'gnss_error', scale: 1, reach: 2 },
};

/** The greatest number of a quantity's series at a time of the plots; null: unknown. */
export function quantityAt(plots: Plots, quantity: Quantity, time: number): number | null {
  const known = plots.series
    .filter(({ name }) => name === quantity.series)
    .map((series) => valueAt(series, time, quantity.reach))
    .filter((value) => value !== null);
  return known.length === 0 ? null : quantity.scale * Math.max(...known.map(Math.abs));
}

/** The end of a scale that holds nearly all numbers: of 1, 2, 3, 5 and 8 times a power of ten. */
export function niceEnd(numbers: number[]): number {
  const sorted = numbers.filter(Number.isFinite).sort((a, b) => a - b);
  const most = sorted[Math.min(sorted.length - 1, Math.floor(0.98 * sorted.length))] ?? 0;
  if (most <= 0) return 1;
  const power = 10 ** Math.floor(Math.log10(most));
  const factor = [1, 2, 3, 5, 8, 10].find((candidate) => candidate * power >= most * (1 - 1e-9)) ?? 10;
  return Number((factor * power).toPrecision(1));
}
