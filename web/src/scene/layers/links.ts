// Pairs of moments at which the same place was seen: loops within a drive, links between two. An arc joins
// both, which lie close to each other where the map is right.

import * as THREE from 'three';

import type { Report } from '../../api/map_files';
import type { Vector } from '../../api/types';
import { kAccepted, kCasing, kOpen, kRejected } from './colors';
import { fatLines, segmentsOf } from './fat_lines';
import { placeAt, type Track } from './track';

export interface Edge {
  from: Vector;
  to: Vector;
  state: 'accepted' | 'rejected' | 'open';
}

/** Of a drive; null while its way is not known. */
export type TrackOf = (drive: string) => Track | null;

const kSteps = 12; // of an arc
const kRise = 0.8; // [m] of an arc's middle above its ends, and a tenth of its length
const kAccept = 0.5; // of the weight that the adjustment left a link

function stateOf(state: unknown): Edge['state'] {
  if (state === 'accepted') return 'accepted';
  return typeof state === 'string' && state.startsWith('forced') ? 'open' : 'rejected';
}

/** [s] since a track's start of a time in seconds on the drive's clock. */
const sinceStart = ({ start }: Track, time: number) => time - Number(start);

function edgeBetween(a: Track | null, timeA: unknown, b: Track | null, timeB: unknown, state: Edge['state']): Edge | null {
  if (!a || !b || typeof timeA !== 'number' || typeof timeB !== 'number') return null;
  const [from, to] = [placeAt(a, sinceStart(a, timeA)), placeAt(b, sinceStart(b, timeB))];
  return from && to ? { from, to, state } : null;
}

/** Edges that can be drawn, and how many the report has in all. */
export interface Edges {
  edges: Edge[];
  count: number;
}

const drawn = (edges: (Edge | null)[]): Edges => ({ edges: edges.filter((edge) => edge !== null), count: edges.length });

export function loopsOf(report: Report, trackOf: TrackOf): Edges {
  return drawn(
    report.drives.flatMap(({ name, loops }) =>
      (loops?.candidates ?? []).map((loop) => {
        const track = trackOf(name);
        return edgeBetween(track, loop['earlier'], track, loop['later'], stateOf(loop['state']));
      }),
    ),
  );
}

interface Pair {
  a: string;
  b: string;
  rejected: string;
  /** Reports of before 0.2 name places only; without times nobody knows where these are. */
  links: { time_a?: number; time_b?: number; weight: number; state?: string }[];
}

const pairsOf = (report: Report) => (report.join?.pairs ?? []) as Pair[];

export function linksOf(report: Report, trackOf: TrackOf): Edges {
  return drawn(
    pairsOf(report).flatMap(({ a, b, rejected, links }) =>
      links.map(({ time_a, time_b, weight, state }) => {
        const isBelieved = rejected === '' && weight > kAccept;
        return edgeBetween(trackOf(a), time_a, trackOf(b), time_b, state === undefined ? (isBelieved ? 'accepted' : 'rejected') : stateOf(state));
      }),
    ),
  );
}

/** Points of the arc over an edge. */
export function arcOf({ from, to }: Edge): Vector[] {
  const rise = kRise + 0.1 * Math.hypot(...from.map((value, axis) => value - to[axis]!));
  return Array.from({ length: kSteps + 1 }, (_, i) => {
    const share = i / kSteps;
    const [x, y, z] = from.map((value, axis) => value + share * (to[axis]! - value)) as Vector;
    return [x, y, z + rise * 4 * share * (1 - share)];
  });
}

const kColors = { accepted: kAccepted, rejected: kRejected, open: kOpen };

export function makeEdges(edges: Edge[]): THREE.Object3D[] {
  const [ends, colors]: [Vector[], THREE.Color[]] = [[], []];
  for (const edge of edges) {
    const arc = segmentsOf(arcOf(edge));
    // What is not accepted is broken, so that no one needs its color.
    const shown = edge.state === 'accepted' ? arc : arc.filter((_, i) => Math.floor(i / 2) % 2 === 0);
    ends.push(...shown);
    colors.push(...shown.map(() => new THREE.Color(kColors[edge.state])));
  }
  if (ends.length === 0) return [];
  return [fatLines(ends, { width: 5, color: kCasing, opacity: 0.5, order: 3 }), fatLines(ends, { width: 2.5, colors, order: 4 })];
}
