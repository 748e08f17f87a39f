// Where a site lies on Earth, for the overview: the box about its map, by its datum.

import type { Site } from '../api/types';
import { geoJsonFromSite } from '../scene/geo';

export type LonLat = [number, number];

/** Corners of the box, counterclockwise and closed; null where the site is not on Earth, or has no map. */
export function outlineOf({ datum, bounds }: Pick<Site, 'datum' | 'bounds'>): LonLat[] | null {
  if (!datum || !bounds) return null;
  const toEarth = geoJsonFromSite(datum);
  const [x0, y0] = bounds.min as [number, number, number];
  const [x1, y1] = bounds.max as [number, number, number];
  const corners: [number, number][] = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
  return corners.map(([x, y]) => toEarth([x, y, 0]).slice(0, 2) as LonLat);
}

/** The middle of an outline, where its label stands. */
export function middleOf(outline: readonly LonLat[]): LonLat {
  const [west, south, east, north] = boxOf([outline])!;
  return [(west + east) / 2, (south + north) / 2];
}

/** West, south, east, north of all outlines; null of none. */
export function boxOf(outlines: readonly (readonly LonLat[])[]): [number, number, number, number] | null {
  const points = outlines.flat();
  if (points.length === 0) return null;
  const longitudes = points.map(([longitude]) => longitude);
  const latitudes = points.map(([, latitude]) => latitude);
  return [Math.min(...longitudes), Math.min(...latitudes), Math.max(...longitudes), Math.max(...latitudes)];
}
