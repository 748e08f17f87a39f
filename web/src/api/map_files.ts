// Files of a map version, which the description of the service only names.

import { addressOf, fetchJson, request } from './client';
import type { MapVersion, Vector } from './types';

export const fetchMap = (site: string, version: string) =>
  request('get', '/api/v1/sites/{site}/maps/{version}', { path: { site, version } });

export const fileUrl = ({ site, version }: Pick<MapVersion, 'site' | 'version'>, file: string) =>
  addressOf('get', '/api/v1/sites/{site}/maps/{version}/{file}', { path: { site, version: String(version), file } });

export const hasFile = (map: MapVersion, name: string) => map.files.some((file) => file.name === name);

/** A pin as report.json has it. */
export interface ReportPin {
  point: Vector;
  latitude_deg: number;
  longitude_deg: number;
  height: number | null;
  is_used: boolean;
  residual: Vector | null; // [m] east, north, up
}

export interface ReportDrive {
  name: string;
  length: number;
  duration: number;
  num_keyframes: number;
  loops?: { candidates: Record<string, unknown>[]; review?: { rejected: unknown[]; forced: unknown[] }; [key: string]: unknown };
  [key: string]: unknown;
}

/** The part of report.json that the page shows. */
export interface Report {
  pins?: ReportPin[];
  drives: ReportDrive[];
  map: { ground_area: number; num_triangles: number; [key: string]: unknown };
  stages: { name: string; seconds: number }[];
  warnings: string[];
  join?: { pairs: unknown[]; [key: string]: unknown } | null;
  [key: string]: unknown;
}

export const fetchReport = async (map: MapVersion) => (await fetchJson(fileUrl(map, 'report.json'))) as Report;

export interface Feature<Properties> {
  properties: Properties;
  /** Positions are [longitude, latitude, height], or points of the site where it is not georeferenced. */
  geometry: { type: 'Polygon' | 'LineString' | 'Point' | 'MultiPolygon'; coordinates: unknown };
}

export interface Collection<Properties> {
  features: Feature<Properties>[];
}

export type SlotState = 'free' | 'occupied' | 'unseen';

export interface SlotProperties {
  id: string;
  type: string;
  state: SlotState;
  states: Record<string, SlotState>; // by drive
  level: number;
  confidence: number;
  width_m: number;
  length_m: number;
  corners_m: Vector[];
}

export interface FreeSpaceProperties {
  level: number;
  area_m2: number;
  min_height_m: number;
  max_height_m: number;
  mean_height_m: number;
}

export interface MarkingProperties {
  type: string; // line, area, kerb, speed_bump, ...
  level: number;
  color?: string;
  [key: string]: unknown;
}

export interface SurfaceProperties {
  surface: string;
  level: number;
  area_m2: number;
}

/** A GeoJSON file of a map; empty where this version has none. */
export async function fetchCollection<Properties>(map: MapVersion, name: string): Promise<Collection<Properties>> {
  if (!hasFile(map, name)) return { features: [] };
  return (await fetchJson(fileUrl(map, name))) as Collection<Properties>;
}

export interface TrajectoryPose {
  time: number; // [s] on the drive's clock, since the trajectory's first pose
  position: Vector;
  orientation: [number, number, number, number]; // x, y, z, w
}

/** Poses of a TUM file. Times are given since `origin`, [s]; without it, since the first pose. */
export function parseTum(text: string, origin?: string): TrajectoryPose[] {
  const poses: TrajectoryPose[] = [];
  let start = origin;
  for (const line of text.split('\n')) {
    if (line === '' || line.startsWith('#')) continue;
    const [stamp, ...rest] = line.trim().split(/\s+/);
    const values = rest.map(Number);
    if (stamp === undefined || values.length < 7 || !values.every(Number.isFinite)) continue;
    start ??= stamp;
    const [x, y, z, qx, qy, qz, qw] = values as [number, number, number, number, number, number, number];
    poses.push({ time: secondsBetween(start, stamp), position: [x, y, z], orientation: [qx, qy, qz, qw] });
  }
  return poses;
}

/** [s] from one stamp to another, both decimal seconds of up to nine digits: no double holds them whole. */
export function secondsBetween(from: string, to: string): number {
  const [fromWhole = '0', fromPart = ''] = from.split('.');
  const [toWhole = '0', toPart = ''] = to.split('.');
  const fraction = (part: string) => Number(`0.${part || '0'}`);
  return Number(toWhole) - Number(fromWhole) + fraction(toPart) - fraction(fromPart);
}

/** The final trajectory of a drive, site_from_imu. */
export async function fetchTrajectory(map: MapVersion, drive: string, file = 'trajectory.tum'): Promise<TrajectoryPose[]> {
  const response = await fetch(fileUrl(map, `${drive}/${file}`));
  return response.ok ? parseTum(await response.text()) : [];
}
