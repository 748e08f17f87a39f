// What lines and areas measure. No page in here: the service computes the same numbers of what is saved.

import type { Schemas } from '../api/client';
import type { Vector } from '../api/types';

export type Kind = Schemas['MeasurementKind'];

/** How many points a measurement takes, as the service does. */
export const kPointsOf: Record<Kind, { least: number; most: number }> = {
  distance: { least: 2, most: 200 },
  area: { least: 3, most: 200 },
  height: { least: 2, most: 2 },
  slope: { least: 2, most: 2 },
  section: { least: 2, most: 200 },
};

/** [m] along a line. */
export function lengthOf(points: Vector[]): number {
  return sumOfSteps(points, (from, to) => Math.hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
}

/** [m] along a line as it is seen from above. */
export function runOf(points: Vector[]): number {
  return sumOfSteps(points, (from, to) => Math.hypot(to[0] - from[0], to[1] - from[1]));
}

function sumOfSteps(points: Vector[], lengthBetween: (from: Vector, to: Vector) => number): number {
  return points.slice(1).reduce((sum, to, i) => sum + lengthBetween(points[i]!, to), 0);
}

/** [m²] as it is seen from above; the shoelace formula about the first point keeps digits. */
export function areaOf(points: Vector[]): number {
  const [first] = points;
  if (!first) return 0;
  let twice = 0;
  for (let i = 2; i < points.length; ++i) {
    const [before, at] = [points[i - 1]!, points[i]!];
    twice += (before[0] - first[0]) * (at[1] - first[1]) - (at[0] - first[0]) * (before[1] - first[1]);
  }
  return Math.abs(twice) / 2;
}

/** [m] by which the last point lies above the first. */
export const riseOf = (points: Vector[]) => (points.at(-1)?.[2] ?? 0) - (points[0]?.[2] ?? 0);

/** The middle of what the points take up. */
export function centerOf(points: Vector[]): Vector {
  return [0, 1, 2].map((axis) => {
    const values = points.map((point) => point[axis]!);
    return (Math.min(...values) + Math.max(...values)) / 2;
  }) as Vector;
}

/** Percent: rise per run; null where the points lie above each other. */
export function slopeOf(points: Vector[]): number | null {
  const run = runOf(points);
  return run < 1e-3 ? null : (100 * riseOf(points)) / run;
}

/** The number that a measurement is about; null where its points do not say one yet. */
export function valueOf(kind: Kind, points: Vector[]): number | null {
  if (points.length < kPointsOf[kind].least) return null;
  switch (kind) {
    case 'distance': return lengthOf(points);
    case 'area': return areaOf(points);
    case 'height': return riseOf(points);
    case 'slope': return slopeOf(points);
    case 'section': return runOf(points);
  }
}

/** With its sign where it may be up or down, and no -0. */
function signed(value: number, digits: number, unit: string): string {
  const shown = Number(value.toFixed(digits)) || 0;
  return `${shown > 0 ? '+' : ''}${shown.toFixed(digits)} ${unit}`;
}

export function formatValue(kind: Kind, value: number): string {
  switch (kind) {
    case 'area': return `${value.toFixed(value < 100 ? 2 : 1)} m²`;
    case 'slope': return signed(value, 1, '%');
    case 'height': return signed(value, 3, 'm');
    default: return `${value.toFixed(2)} m`;
  }
}
