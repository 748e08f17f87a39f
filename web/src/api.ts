// What the page asks the service for.

import { addressOf, fetchJson, request, type Schemas } from './api_client';

export type Drive = Schemas['Drive'];
export type Site = Schemas['Site'];
export type Job = Schemas['Job'];
export type MapVersion = Schemas['Map'];
export type Vector = Schemas['Point'];

// Files of a map, which the description of the service only names.

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
    properties: { id: string; type: string; state: SlotState; confidence: number; corners_m: Vector[] };
  }[];
}

/** The part of surfaces.geojson that the page shows. */
export interface SurfaceCollection {
  features: {
    properties: { surface: string; level: number; area_m2: number };
    geometry: { coordinates: number[][][] }; // rings of [longitude, latitude, height] or of points of the site
  }[];
}

/** All pages of a list, newest first. */
async function all<Item>(
  pageAfter: (query: { limit: number; cursor?: string }) => Promise<{ items: Item[]; next_cursor: string | null }>,
): Promise<Item[]> {
  const items: Item[] = [];
  let cursor: string | null = null;
  do {
    const page = await pageAfter({ limit: 100, ...(cursor === null ? {} : { cursor }) });
    items.push(...page.items);
    cursor = page.next_cursor;
  } while (cursor !== null);
  return items;
}

export const listDrives = () => all((query) => request('get', '/api/v1/drives', { query }));
export const listSites = () => all((query) => request('get', '/api/v1/sites', { query }));
export const listJobs = () => all((query) => request('get', '/api/v1/jobs', { query }));

export const latestMap = (site: string) =>
  request('get', '/api/v1/sites/{site}/maps/{version}', { path: { site, version: 'latest' } });

export const fileUrl = ({ site, version }: MapVersion, file: string) =>
  addressOf('get', '/api/v1/sites/{site}/maps/{version}/{file}', { path: { site, version: String(version), file } });

export const report = async (map: MapVersion) => (await fetchJson(fileUrl(map, 'report.json'))) as Report;

/** The parking slots of a map; none of one that an older version made. */
export async function slots(map: MapVersion): Promise<SlotCollection> {
  if (!map.files.some((file) => file.name === 'slots.geojson')) return { features: [] };
  return (await fetchJson(fileUrl(map, 'slots.geojson'))) as SlotCollection;
}

/** What lies beside the free space of a map; nothing of one that an older version made. */
export async function surfaces(map: MapVersion): Promise<SurfaceCollection> {
  if (!map.files.some((file) => file.name === 'surfaces.geojson')) return { features: [] };
  return (await fetchJson(fileUrl(map, 'surfaces.geojson'))) as SurfaceCollection;
}

/** Builds a version from another one, with these pins in place of those it has. */
export const buildWithPins = ({ site, version }: MapVersion, pins: Schemas['WantedPin'][]) =>
  request('post', '/api/v1/sites/{site}/maps', { path: { site }, body: { from: version, pins } });

/** Calls `onChange` whenever a job or a map changed; reconnects by itself. */
export function watchEvents(onChange: () => void): void {
  const events = new EventSource(addressOf('get', '/api/v1/events'));
  for (const kind of ['job', 'map', 'drive']) events.addEventListener(kind, onChange);
  events.addEventListener('open', onChange); // what happened while disconnected
}
