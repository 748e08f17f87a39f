// Where in the map things lie that comments are pinned to.

import { request } from '../api/client';
import { fetchCollection, fileUrl, parseTum, type Report, type SlotProperties } from '../api/map_files';
import type { MapVersion, Vector } from '../api/types';
import { centerOf } from '../scene/layers/slots';
import { placeAt, type Track } from '../scene/layers/track';
import type { CommentPin } from './threads';

interface JoinedPair {
  a: string; // drives
  b: string;
  links: { place_a: number; place_b: number; time_b?: number }[]; // maps of before have no times
}

/** The drive and the time [s, its clock] of a loop's later place, or of a link's place in the other drive; null where the report does not name it. */
export function timeOfLoop(report: Pick<Report, 'drives' | 'join'>, loop: string): { drive: string; time: number } | null {
  for (const { a, b, links } of (report.join?.pairs ?? []) as JoinedPair[]) {
    const time = links.find(({ place_a, place_b }) => loop === `${a}:${place_a}~${b}:${place_b}`)?.time_b;
    if (time !== undefined) return { drive: b, time };
  }
  const colon = loop.lastIndexOf(':');
  const [name, id] = [colon < 0 ? null : loop.slice(0, colon), loop.slice(colon + 1)];
  for (const drive of report.drives) {
    if (name !== null && drive.name !== name) continue;
    const later = drive.loops?.candidates.find((candidate) => candidate['id'] === id)?.['later'];
    if (typeof later === 'number') return { drive: drive.name, time: later };
  }
  return null;
}

const kClock = '0'; // where a drive's clock starts

/** Files are fetched when the first pin needs them, and once. */
export class Places {
  private slots: Promise<Map<string, Vector>> | null = null;
  private readonly tracks = new Map<string, Promise<Track>>();
  private readonly starts = new Map<string, Promise<number>>();

  constructor(
    private readonly map: MapVersion,
    private readonly report: Report,
  ) {}

  /** Null where it is about no place, or one that this version does not have. */
  async of(pin: CommentPin | null): Promise<Vector | null> {
    if (pin?.point) return pin.point;
    if (pin?.slot !== undefined) return (await this.allSlots()).get(pin.slot) ?? null;
    if (pin?.loop !== undefined) {
      const found = timeOfLoop(this.report, pin.loop);
      return found ? placeAt(await this.track(found.drive), found.time) : null;
    }
    const drive = this.map.drives.find(({ id }) => id === pin?.drive);
    return drive && pin?.time !== undefined ? placeAt(await this.track(drive.name), pin.time) : null;
  }

  /** Middles of slots, by id. */
  allSlots(): Promise<Map<string, Vector>> {
    this.slots ??= fetchCollection<SlotProperties>(this.map, 'slots.geojson').then(
      ({ features }) => new Map(features.map(({ properties: { id, corners_m } }) => [id, centerOf(corners_m)])),
    );
    return this.slots;
  }

  /** When the plots of a drive begin, [s] on its clock. */
  startOf(drive: string): Promise<number> {
    let start = this.starts.get(drive);
    if (!start) {
      const query = { version: String(this.map.version), points: 2 };
      start = request('get', '/api/v1/drives/{drive}/plots', { path: { drive }, query }).then((plots) => Number(plots.start));
      this.starts.set(drive, start);
    }
    return start;
  }

  /** Its times are those of the drive's clock. */
  private track(name: string): Promise<Track> {
    let track = this.tracks.get(name);
    if (!track) {
      track = fetch(fileUrl(this.map, `${name}/trajectory.tum`)).then(async (response) => ({
        start: kClock,
        poses: response.ok ? parseTum(await response.text(), kClock) : [],
      }));
      this.tracks.set(name, track);
    }
    return track;
  }
}
