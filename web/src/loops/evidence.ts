// Places that were seen twice, within a drive or by two of them, as report.json has them, by how much they are to be doubted.

import type { Report } from '../api/map_files';

/** One of a drive's places: keyframes of the whole rig, two meters apart, numbered along the drive. */
export interface PlaceName {
  drive: string;
  index: number;
}

export interface CameraPair {
  a: string;
  b: string;
  inliers: number;
}

/** Inliers of the two cameras that share the most. */
export interface ShownInliers {
  /** By name, or by the number in the drive's rig. */
  cameras: { a: string | number; b: string | number };
  /** Of the two images, decimal seconds on the drives' clocks: exact. */
  times: { a: string; b: string };
  /** In shares of the images' widths and heights. */
  points: { a: [number, number]; b: [number, number] }[];
}

export interface Evidence {
  /** DRIVE:EARLIER-LATER of a loop, as the service names it; DRIVE:PLACE~DRIVE:PLACE of a link. */
  id: string;
  kind: 'loop' | 'link';
  a: PlaceName; // the earlier
  b: PlaceName;
  /** [s] on the drives' clocks; null where the report does not say. */
  times: { a: number; b: number } | null;
  inliers: number;
  cameraPairs: number;
  /** Those that share inliers, the most first; empty where the report does not say. */
  cameras: CameraPair[];
  /** Null in maps of before. */
  shown: ShownInliers | null;
  score: number; // by place recognition
  residual: number; // [sigma] RMS of the inliers
  chiSquared: number; // [sigma^2] of six, once all are closed
  worstSigma: number; // [m]
  isAccepted: boolean;
  /** In the words of the report. */
  state: string;
  /** Small pictures that the version itself has, for when the log is gone; files of the map. */
  thumbnails: { a: string | null; b: string | null };
}

interface ReportInliers {
  cameras: [string | number, string | number];
  times: [string, string];
  points: [number, number, number, number][];
}

interface Measured {
  num_inliers: number;
  num_camera_pairs: number;
  score: number;
  residual: number;
  chi_squared: number;
  worst_sigma: number;
  weight: number;
  inliers?: ReportInliers;
}

interface ReportLoop extends Measured {
  id: string;
  earlier: number;
  later: number;
  state: string;
  camera_pairs: { earlier: string; later: string; num_inliers: number }[];
  thumbnails?: string[]; // DRIVE/loops/00017-CAMERA.jpg
}

interface ReportLink extends Measured {
  place_a: number;
  place_b: number;
  time_a?: number; // [s] on the drive's clock; missing in maps of before
  time_b?: number;
  state?: string; // missing in maps of before
}

interface ReportPair {
  a: string;
  b: string;
  rejected: string;
  links: ReportLink[];
}

const kAccepted = ['accepted', 'forced by the reviewer'];
const kMaxChiSquared = 12.59; // of 19 in 20 right ones, with six degrees of freedom
const kMinInliers = 25; // that the mapper asks for

function shownOf(inliers: ReportInliers | undefined): ShownInliers | null {
  if (!inliers || inliers.points.length === 0) return null;
  return {
    cameras: { a: inliers.cameras[0], b: inliers.cameras[1] },
    times: { a: inliers.times[0], b: inliers.times[1] },
    points: inliers.points.map(([xa, ya, xb, yb]) => ({ a: [xa, ya], b: [xb, yb] })),
  };
}

const measures = (of: Measured) => ({
  shown: shownOf(of.inliers),
  inliers: of.num_inliers,
  cameraPairs: of.num_camera_pairs,
  score: of.score,
  residual: of.residual,
  chiSquared: of.chi_squared,
  worstSigma: of.worst_sigma,
});

const thumbnailOf = ({ thumbnails = [] }: ReportLoop, place: number): string | null =>
  thumbnails.find((name) => name.includes(`/loops/${String(place).padStart(5, '0')}-`)) ?? null;

function loopsOf(report: Report): Evidence[] {
  return report.drives.flatMap(({ name, loops }) =>
    ((loops?.candidates ?? []) as unknown as ReportLoop[]).map((loop) => {
      const [earlier = 0, later = 0] = loop.id.split('-').map(Number);
      return {
        ...measures(loop),
        id: `${name}:${loop.id}`,
        kind: 'loop' as const,
        a: { drive: name, index: earlier },
        b: { drive: name, index: later },
        times: { a: loop.earlier, b: loop.later },
        cameras: loop.camera_pairs.map((pair) => ({ a: pair.earlier, b: pair.later, inliers: pair.num_inliers })),
        isAccepted: kAccepted.includes(loop.state),
        state: loop.state,
        thumbnails: { a: thumbnailOf(loop, earlier), b: thumbnailOf(loop, later) },
      };
    }),
  );
}

function linksOf(report: Report): Evidence[] {
  return ((report.join?.pairs ?? []) as ReportPair[]).flatMap((pair) =>
    pair.links.map((link) => {
      const isBelieved = link.weight > 0.5 && pair.rejected === '';
      const state = link.state ?? (isBelieved ? 'accepted' : pair.rejected || 'rejected by the pose graph');
      return {
        ...measures(link),
        id: `${pair.a}:${link.place_a}~${pair.b}:${link.place_b}`,
        kind: 'link' as const,
        a: { drive: pair.a, index: link.place_a },
        b: { drive: pair.b, index: link.place_b },
        times: link.time_a !== undefined && link.time_b !== undefined ? { a: link.time_a, b: link.time_b } : null,
        cameras: [],
        isAccepted: kAccepted.includes(state),
        state,
        thumbnails: { a: null, b: null },
      };
    }),
  );
}

/** How little an item is backed: few inliers, or far from where everything else puts it. */
function doubtOf({ inliers, chiSquared }: Pick<Evidence, 'inliers' | 'chiSquared'>): number {
  return kMinInliers / Math.max(inliers, 1) + chiSquared / kMaxChiSquared;
}

/** Accepted ones with the least evidence first, as they bend the map; then rejected ones with the most. */
export function byDoubt(all: readonly Evidence[]): Evidence[] {
  return [...all].sort((one, other) => {
    if (one.isAccepted !== other.isAccepted) return one.isAccepted ? -1 : 1;
    return one.isAccepted ? doubtOf(other) - doubtOf(one) : doubtOf(one) - doubtOf(other);
  });
}

export const evidenceOf = (report: Report): Evidence[] => byDoubt([...loopsOf(report), ...linksOf(report)]);

/** What is odd about an item, in words; empty where nothing is. */
export function doubtsOf(item: Evidence): string[] {
  const doubts: string[] = [];
  if (item.inliers < 2 * kMinInliers) doubts.push('few inliers');
  if (item.cameraPairs < 2) doubts.push('seen by one pair of cameras');
  if (item.chiSquared > kMaxChiSquared) doubts.push('contradicts the rest of the map');
  if (item.worstSigma > 0.1) doubts.push('its position is vague');
  return doubts;
}

export const titleOf = ({ kind, a, b }: Pick<Evidence, 'kind' | 'a' | 'b'>): string =>
  kind === 'loop' ? `${a.drive}: ${a.index} ↔ ${b.index}` : `${a.drive} ${a.index} ↔ ${b.drive} ${b.index}`;

export interface Filter {
  kind: 'all' | 'loop' | 'link';
  state: 'all' | 'accepted' | 'rejected';
  decision: 'all' | 'decided' | 'undecided';
}

export function filtered(all: readonly Evidence[], filter: Filter, isDecided: (id: string) => boolean): Evidence[] {
  return all.filter(
    (item) =>
      (filter.kind === 'all' || item.kind === filter.kind) &&
      (filter.state === 'all' || item.isAccepted === (filter.state === 'accepted')) &&
      (filter.decision === 'all' || isDecided(item.id) === (filter.decision === 'decided')),
  );
}
