// What a comparison found, as a list to step through: regions of the ground, then slots.

import type { Collection, SlotProperties } from '../api/map_files';
import type { Comparison, Vector } from '../api/types';
import { moved } from './alignment';
import type { Matrix4 } from 'three';

export type ChangeKind = Comparison['regions'][number]['change'] | 'slot added' | 'slot removed' | 'slot state';

export interface Change {
  id: string; // "region 3", "slot slot_2419d4eac1"
  kind: ChangeKind;
  title: string;
  /** What it means for a car, or how much of it there is. */
  about: string;
  isLoss: boolean; // of room to drive or to park in
  point: Vector | null; // in the later site
  reach: number; // [m] about the point
  /** Rings in the later site. */
  outline: Vector[][];
}

export interface RegionProperties {
  id: number;
  change: Comparison['regions'][number]['change'];
  area_m2: number;
  height_change_m: number;
}

export const kMeanings: Record<Comparison['regions'][number]['change'], string> = {
  freed: 'was seen and not drivable, is drivable now',
  blocked: 'was drivable, is seen and not drivable now',
  mapped: 'was not seen, is drivable',
  unmapped: 'was drivable, is not seen any more',
  raised: 'the ground lies higher',
  lowered: 'the ground lies lower',
};

const area = (value: number) => `${value.toFixed(value < 10 ? 1 : 0)} m²`;
export const centimeters = (value: number) => `${value > 0 ? '+' : ''}${(100 * value).toFixed(1)} cm`;
const capital = (word: string) => word.charAt(0).toUpperCase() + word.slice(1);
const shortSlot = (id: string) => id.replace(/^slot_/, '');

function middleOf(points: readonly Vector[]): Vector | null {
  if (points.length === 0) return null;
  return [0, 1, 2].map((axis) => points.reduce((sum, point) => sum + point[axis]!, 0) / points.length) as Vector;
}

function reachOf(middle: Vector | null, rings: readonly Vector[][]): number {
  if (!middle) return 0;
  return Math.max(1, ...rings.flat().map((point) => Math.hypot(point[0] - middle[0], point[1] - middle[1])));
}

/** Rings of a Polygon or a MultiPolygon. */
function ringsOf(geometry: { type: string; coordinates: unknown }, toSite: (position: number[]) => Vector): Vector[][] {
  const polygons = (geometry.type === 'MultiPolygon' ? geometry.coordinates : [geometry.coordinates]) as number[][][][];
  return polygons.flat().map((ring) => ring.map(toSite));
}

export interface Sources {
  comparison: Comparison;
  regions: Collection<RegionProperties>;
  /** Of the later version's GeoJSON. */
  toSite: (position: number[]) => Vector;
  slots: { earlier: Collection<SlotProperties>; later: Collection<SlotProperties> };
  laterFromEarlier: Matrix4;
}

export function changesOf({ comparison, regions, toSite, slots, laterFromEarlier }: Sources): Change[] {
  const outlines = new Map(regions.features.map(({ properties, geometry }) => [properties.id, ringsOf(geometry, toSite)]));
  const ofRegions = comparison.regions.map((region): Change => {
    const outline = outlines.get(region.id) ?? [];
    const point = region.center as Vector;
    const isOfHeight = region.change === 'raised' || region.change === 'lowered';
    return {
      id: `region ${region.id}`,
      kind: region.change,
      title: `${capital(region.change)}, ${area(region.area)}`,
      about: kMeanings[region.change] + (isOfHeight ? ` by ${centimeters(Math.abs(region.height_change)).replace('+', '')}` : ''),
      isLoss: region.change === 'blocked' || region.change === 'unmapped',
      point,
      reach: reachOf(point, outline),
      outline,
    };
  });

  const cornersOf = (collection: Collection<SlotProperties>, id: string): Vector[] =>
    collection.features.find(({ properties }) => properties.id === id)?.properties.corners_m ?? [];
  const ofSlot = (id: string, kind: ChangeKind, title: string, about: string, isLoss: boolean, corners: Vector[]): Change => {
    const point = middleOf(corners);
    const outline = corners.length > 0 ? [[...corners, corners[0]!]] : [];
    return { id: `slot ${id}`, kind, title, about, isLoss, point, reach: reachOf(point, outline), outline };
  };
  const inLater = (id: string) => cornersOf(slots.later, id);
  const inEarlier = (id: string) => cornersOf(slots.earlier, id).map((corner) => moved(corner, laterFromEarlier));
  const { added, removed, changed } = comparison.slots;
  return [
    ...ofRegions,
    ...removed.map((id) => ofSlot(id, 'slot removed', 'Slot is gone', `${shortSlot(id)} is in the earlier version alone`, true, inEarlier(id))),
    ...added.map((id) => ofSlot(id, 'slot added', 'Slot is new', `${shortSlot(id)} is in the later version alone`, false, inLater(id))),
    ...changed.map(({ id, from, to }) => ofSlot(id, 'slot state', `Slot is ${to} now`, `${shortSlot(id)} was ${from}`, to === 'occupied', inLater(id))),
  ];
}

/** What a comparison says, in sentences; what matters most comes first. */
export function sentencesOf(comparison: Comparison): string[] {
  const { free_space: space, heights, slots, drives, trajectories, alignment } = comparison;
  const sentences: string[] = [];
  const part = (value: number, text: string) => (value >= 0.05 ? [`${area(value)} ${text}`] : []);
  const gained = [...part(space.freed, 'freed'), ...part(space.mapped, 'newly mapped')];
  const lost = [...part(space.blocked, 'blocked'), ...part(space.unmapped, 'no longer seen')];
  if (gained.length + lost.length === 0) sentences.push('Free space is the same.');
  else {
    if (lost.length > 0) sentences.push(`Free space lost: ${lost.join(', ')}.`);
    if (gained.length > 0) sentences.push(`Free space gained: ${gained.join(', ')}.`);
  }
  const heightParts = [...part(heights.raised, 'raised'), ...part(heights.lowered, 'lowered')];
  sentences.push(
    heightParts.length > 0
      ? `The ground changed its height: ${heightParts.join(', ')}.`
      : `The ground's height is the same within ${(100 * heights.percentile_95).toFixed(1)} cm at 19 of 20 spots.`,
  );
  const counted = (count: number, what: string) => (count > 0 ? [`${count} ${what}`] : []);
  const ofSlots = [...counted(slots.added.length, 'new'), ...counted(slots.removed.length, 'gone'), ...counted(slots.changed.length, 'of another state')];
  if (ofSlots.length > 0) sentences.push(`Slots: ${ofSlots.join(', ')}; ${slots.kept} kept.`);
  else if (slots.kept > 0) sentences.push(`All ${slots.kept} slots are the same.`);
  if (drives.added.length > 0) sentences.push(`New drives: ${drives.added.join(', ')}.`);
  if (drives.removed.length > 0) sentences.push(`Drives no longer in it: ${drives.removed.join(', ')}.`);
  const worst = trajectories.reduce<(typeof trajectories)[number] | null>((most, one) => (!most || one.largest > most.largest ? one : most), null);
  if (worst) sentences.push(`Trajectories moved by ${(100 * worst.largest).toFixed(1)} cm at most (${worst.drive}).`);
  if (alignment.note !== '') sentences.push(capital(alignment.note.replace(/\.?$/, '.')));
  return sentences;
}

const kAlignedBy: Record<Comparison['alignment']['aligned_by'], string> = {
  drives: 'by the drives that both have',
  places: 'by places that drives of both passed',
  datum: 'by where both lie on Earth, which registers nothing: differences may be of GNSS alone',
};

/** How the earlier version was laid over the later one. */
export function alignmentSentence({ alignment }: Comparison): string {
  const distance = Math.hypot(...alignment.translation);
  const links = alignment.num_links > 0 ? `, ${alignment.num_links} links` : '';
  return (
    `The earlier version was moved by ${distance.toFixed(2)} m and turned by ${alignment.yaw_deg.toFixed(2)}° ${kAlignedBy[alignment.aligned_by]}${links}. ` +
    `It may be off by ${(100 * alignment.horizontal_sigma).toFixed(1)} cm, and ${(100 * alignment.height_sigma).toFixed(1)} cm in height; changes within three times that are left out.`
  );
}

/** Slots whose state two drives of one version tell differently. */
export function slotsThatDiffer(slots: Collection<SlotProperties>, from: string, to: string): Change[] {
  const changes: Change[] = [];
  for (const { properties } of slots.features) {
    const [was, is] = [properties.states[from], properties.states[to]];
    if (was === undefined || is === undefined || was === is || was === 'unseen' || is === 'unseen') continue;
    const corners = properties.corners_m;
    const point = middleOf(corners);
    const outline = corners.length > 0 ? [[...corners, corners[0]!]] : [];
    changes.push({
      id: `slot ${properties.id}`, kind: 'slot state', title: `Slot is ${is} in ${to}`, about: `${shortSlot(properties.id)} was ${was} in ${from}`,
      isLoss: is === 'occupied', point, reach: reachOf(point, outline), outline,
    });
  }
  return changes;
}

/** The slots of two drives, counted. */
export function slotCounts(slots: Collection<SlotProperties>, from: string, to: string): { same: number; different: number; unseen: number } {
  const counts = { same: 0, different: 0, unseen: 0 };
  for (const { properties } of slots.features) {
    const [was = 'unseen', is = 'unseen'] = [properties.states[from], properties.states[to]];
    if (was === 'unseen' || is === 'unseen') counts.unseen += 1;
    else if (was === is) counts.same += 1;
    else counts.different += 1;
  }
  return counts;
}
