// What the layers show of drives: each file and each answer is asked for once.

import { fetchJson, request, type Schemas } from '../api/client';
import { fetchCollection, fileUrl, hasFile, parseTum, type Collection } from '../api/map_files';
import type { Keyframes, MapVersion, Plots } from '../api/types';
import type { Track } from '../scene/layers/track';
import type { MapDrive } from './workspace.svelte';

const kPlotPoints = 4000;
const kKeyframes = 2000; // of a drive: more are thinned by the service

export class DriveData {
  private readonly asked = new Map<string, Promise<unknown>>();

  constructor(readonly map: MapVersion) {}

  collection<Properties>(name: string): Promise<Collection<Properties>> {
    return this.once(name, () => fetchCollection<Properties>(this.map, name));
  }

  /** The final trajectory; without poses where the map has none. */
  track({ name }: MapDrive): Promise<Track> {
    return this.once(`${name}/trajectory.tum`, async () => {
      const response = await fetch(fileUrl(this.map, `${name}/trajectory.tum`));
      if (!response.ok) throw new Error(`the trajectory of ${name} could not be loaded`);
      const text = await response.text();
      return { start: /^[-\d.]+/m.exec(text)?.[0] ?? '0', poses: parseTum(text) };
    });
  }

  plots({ id }: MapDrive): Promise<Plots> {
    const query = { points: kPlotPoints, version: String(this.map.version) };
    return this.once(`plots of ${id}`, () => request('get', '/api/v1/drives/{drive}/plots', { path: { drive: id }, query }));
  }

  keyframes({ id }: MapDrive): Promise<Keyframes> {
    const query = { points: kKeyframes, version: String(this.map.version) };
    return this.once(`keyframes of ${id}`, () => request('get', '/api/v1/drives/{drive}/keyframes', { path: { drive: id }, query }));
  }

  /** Where the drive's GNSS fixes lie; null where it has none, the site is not on Earth, or an older program made the map. */
  fixes({ name }: MapDrive): Promise<Schemas['GnssFixes'] | null> {
    const file = `${name}/gnss.json`;
    return this.once(file, async () => (hasFile(this.map, file) ? ((await fetchJson(fileUrl(this.map, file))) as Schemas['GnssFixes']) : null));
  }

  /** What failed is asked for again next time. */
  private once<Value>(name: string, ask: () => Promise<Value>): Promise<Value> {
    const known = this.asked.get(name);
    if (known) return known as Promise<Value>;
    const asked = ask();
    this.asked.set(name, asked);
    asked.catch(() => this.asked.delete(name));
    return asked;
  }
}
