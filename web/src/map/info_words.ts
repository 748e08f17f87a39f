// What a report says, in words for who decides over a map. No page in here.

import { secondsBetween, type Report, type ReportDrive } from '../api/map_files';
import type { MapVersion } from '../api/types';
import { formatDuration } from '../ui/format';

export interface Stretch {
  begin: number; // [s] since the drive's start
  end: number;
  reason: string;
}

interface Odometry {
  degraded?: { begin: string; end: string; reason: string }[];
}

/** Where a drive is less sure than elsewhere. */
export function stretchesOf(drive: ReportDrive): Stretch[] {
  const streams = drive['streams'] as { begin?: string; role?: string }[] | undefined;
  const start = (streams?.find(({ role }) => role === 'imu') ?? streams?.[0])?.begin; // where trajectories begin
  const degraded = (drive['odometry'] as Odometry | undefined)?.degraded ?? [];
  return degraded.map(({ begin, end, reason }) => ({
    begin: secondsBetween(start ?? begin, begin),
    end: secondsBetween(start ?? begin, end),
    reason,
  }));
}

/** "9.0 s of 14 s (64 %) are less sure"; null where none are. */
export function summaryOfStretches(stretches: Stretch[], duration: number): string | null {
  if (stretches.length === 0) return null;
  const seconds = stretches.reduce((sum, { begin, end }) => sum + end - begin, 0);
  const share = duration > 0 ? ` (${Math.max(1, Math.round((100 * seconds) / duration))} %)` : '';
  return `${seconds.toFixed(1)} s of ${formatDuration(duration)}${share} less sure`;
}

const kWorthASentence = 0.25; // of a drive

/** What a reviewer should know of a drive's stretches before anything else; null: nothing. */
export function warningOfStretches(name: string, stretches: Stretch[], duration: number): string | null {
  const seconds = stretches.reduce((sum, { begin, end }) => sum + end - begin, 0);
  if (!(duration > 0) || seconds / duration < kWorthASentence) return null;
  const longest = [...stretches].sort((a, b) => b.end - b.begin - (a.end - a.begin))[0]!;
  return `${Math.round((100 * seconds) / duration)} % of drive ${name} are less sure than the rest: ${longest.reason}.`;
}

interface Georeference {
  source?: string;
  heights?: string;
  position_sigma?: [number, number, number];
  yaw_sigma?: number;
}

const kSources: Record<string, string> = { gnss: 'by GNSS', pins: 'by pins', none: 'not placed on Earth' };

const centimetersOrMeters = (meters: number) => (meters < 1 ? `${(100 * meters).toFixed(meters < 0.1 ? 1 : 0)} cm` : `${meters.toFixed(1)} m`);

/** How well the map's place on Earth is known: pairs of a word and what holds of it. */
export function georeferenceOf(report: Report, datum: MapVersion['datum']): [string, string][] {
  const known = (report['georeference'] ?? null) as Georeference | null;
  if (!datum || !known) return [['Placed', 'not on Earth: the site has an origin of its own. Pins or GNSS would place it.']];
  const { source = '', heights, position_sigma: sigma, yaw_sigma: yaw } = known;
  const rows: [string, string][] = [['Placed', kSources[source] ?? `by ${source}`]];
  if (sigma) rows.push(['Sigma across', centimetersOrMeters(Math.max(sigma[0], sigma[1]))]);
  if (sigma && heights !== 'unknown') rows.push(['Sigma of height', centimetersOrMeters(sigma[2])]);
  if (yaw !== undefined) rows.push(['Sigma of north', `${((yaw * 180) / Math.PI).toFixed(2)}°`]);
  if (heights) rows.push(['Heights', heights === 'unknown' ? 'unknown: no GNSS, and no pin has one' : heights === 'ellipsoidal' ? 'above the ellipsoid (WGS84)' : heights]);
  return rows;
}

interface Pair {
  a: string;
  b: string;
  num_accepted?: number;
  links?: unknown[];
  rejected?: string;
}

/** How drives hold together: "day1 and day2: 42 of 54 links accepted". */
export const joinsOf = (report: Report): { text: string; isGood: boolean }[] =>
  ((report.join?.pairs ?? []) as Pair[]).map(({ a, b, num_accepted = 0, links = [], rejected = '' }) => ({
    text: rejected === '' ? `${a} and ${b}: ${num_accepted} of ${links.length} links accepted` : `${a} and ${b} are not linked: ${rejected}`,
    isGood: rejected === '' && num_accepted > 0,
  }));

/** Drives that were given and are not in the map, with the reason. */
export const leftOutOf = (report: Report) => (report['left_out'] ?? []) as { name: string; reason: string }[];

export interface SlotCounts {
  count: number;
  free: number;
  occupied: number;
  unseen: number;
}
export const slotCountsOf = (report: Report) => (report.map['slots'] ?? null) as SlotCounts | null;
