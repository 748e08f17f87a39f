// What the service answers, as /api/v1/openapi.json describes it.

import { changeHeaders } from './session';

export type DriveState = 'received' | 'queued' | 'processing' | 'ready' | 'failed';

export interface Drive {
  id: string;
  name: string;
  site: string;
  state: DriveState;
  bytes: number;
  error: string | null;
  created_at: string;
}

/** The part of a site that the page needs. */
export interface Site {
  name: string;
  latest_version: number | null; // none yet
}

export interface Job {
  id: string;
  site: string;
  state: 'queued' | 'running' | 'done' | 'failed' | 'cancelled';
  stage: string | null;
  progress: number;
  eta_seconds: number | null;
  error: string | null;
  drives: string[];
  preview?: string | null; // address of what the map will look like
}

export interface MapFile {
  name: string;
  bytes: number;
}

export interface MapVersion {
  site: string;
  version: number;
  created_at: string;
  files: MapFile[];
}

export type Vector = [number, number, number];

/** A pin as report.json has it. */
export interface ReportPin {
  point: Vector;
  latitude_deg: number;
  longitude_deg: number;
  height: number | null;
  is_used: boolean;
  residual: Vector | null; // [m] east, north, up
}

/** The part of report.json that the page shows. */
export interface Report {
  pins?: ReportPin[];
  drives: { name: string; length: number; duration: number; num_keyframes: number }[];
  map: { ground_area: number; num_triangles: number };
  stages: { name: string; seconds: number }[];
  warnings: string[];
}

export type SlotState = 'free' | 'occupied' | 'unseen';

/** The part of slots.geojson that the page shows. */
export interface SlotCollection {
  features: {
    properties: { id: string; type: string; state: SlotState; confidence: number; corners_m: [number, number, number][] };
  }[];
}

async function answerOf<T>(path: string, response: Response): Promise<T> {
  if (response.ok) return (await response.json()) as T;
  const problem = (await response.json().catch(() => ({}))) as { detail?: string };
  throw new Error(problem.detail ?? `${path}: the service answered ${response.status}`);
}

async function get<T>(path: string): Promise<T> {
  return answerOf<T>(path, await fetch(path, { headers: { accept: 'application/json' } }));
}

const segment = encodeURIComponent;

/** All pages of a list. */
async function list<T>(path: string): Promise<T[]> {
  const items: T[] = [];
  let cursor: string | null = null;
  do {
    const page: { items: T[]; next_cursor: string | null } = await get(
      `${path}?limit=100${cursor ? `&cursor=${segment(cursor)}` : ''}`,
    );
    items.push(...page.items);
    cursor = page.next_cursor;
  } while (cursor);
  return items; // the service lists the newest first, the page wants the newest last
}

export const listDrives = () => list<Drive>('/api/v1/drives');
export const listSites = () => list<Site>('/api/v1/sites');
export const listJobs = () => list<Job>('/api/v1/jobs');

export function mapUrl(site: string, version: number | 'latest', file = ''): string {
  return `/api/v1/sites/${segment(site)}/maps/${version}${file ? `/${file.split('/').map(segment).join('/')}` : ''}`;
}

export const latestMap = (site: string) => get<MapVersion>(mapUrl(site, 'latest'));
export const report = (map: MapVersion) => get<Report>(mapUrl(map.site, map.version, 'report.json'));

/** Builds a version from another one, with these pins in place of those it has. */
export async function buildWithPins(map: MapVersion, pins: object[]): Promise<Job> {
  const path = `/api/v1/sites/${segment(map.site)}/maps`;
  const body = JSON.stringify({ from: map.version, pins });
  return answerOf<Job>(path, await fetch(path, { method: 'POST', headers: { 'content-type': 'application/json', ...changeHeaders() }, body }));
}

/** The parking slots of a map; none of one that an older version made. */
export async function slots(map: MapVersion): Promise<SlotCollection> {
  if (!map.files.some((file) => file.name === 'slots.geojson')) return { features: [] };
  return get<SlotCollection>(mapUrl(map.site, map.version, 'slots.geojson'));
}

/** Calls `onChange` whenever a job or a map changed; reconnects by itself. */
export function watchEvents(onChange: () => void): void {
  const events = new EventSource('/api/v1/events');
  for (const kind of ['job', 'map', 'drive']) events.addEventListener(kind, onChange);
  events.addEventListener('open', onChange); // what happened while disconnected
}
