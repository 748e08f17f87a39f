// What a reviewer has decided about loops and links of a version, before it is built with. It stays in the browser until then.

import type { Schemas } from '../api/client';
import type { Evidence, PlaceName } from './evidence';

export type Verdict = 'accept' | 'reject' | 'force';

export interface Decision {
  id: string; // of an Evidence, or of a pair that the report does not have
  verdict: Verdict;
}

/** The last decision about an item counts, and stands last. */
export function decide(decisions: readonly Decision[], id: string, verdict: Verdict): Decision[] {
  return [...undo(decisions, id), { id, verdict }];
}

export const undo = (decisions: readonly Decision[], id: string): Decision[] => decisions.filter((decision) => decision.id !== id);

type Wanted = { from: number } & Record<'reject_loops' | 'force_loops' | 'reject_links' | 'force_links', string[]>;

/** As POST /sites/NAME/maps takes them. Whoever agrees with the mapper changes nothing. */
export function requestFor(decisions: readonly Decision[], all: readonly Evidence[], version: number): Wanted {
  const wanted: Wanted = { from: version, reject_loops: [], force_loops: [], reject_links: [], force_links: [] };
  for (const { id, verdict } of decisions) {
    const item = all.find((one) => one.id === id);
    const kind = isLink(id) ? 'links' : 'loops';
    const closes = item?.isAccepted ?? false;
    if (verdict === 'reject' && closes) wanted[`reject_${kind}`].push(id);
    if (verdict !== 'reject' && !closes) wanted[`force_${kind}`].push(id);
  }
  return wanted;
}

export const changesIn = ({ from: _, ...lists }: Wanted): number => Object.values(lists).reduce((sum, { length }) => sum + length, 0);

/** What a decision does to the next version, in words. */
export function effectOf({ verdict }: Decision, item: Evidence | undefined): string {
  if (!item) return 'is forced';
  if (verdict === 'reject') return item.isAccepted ? 'is left out' : 'stays out';
  return item.isAccepted ? 'stays' : 'is forced';
}

/** A pair as the service names it: the earlier place first, or that of the drive that the report names first. A sentence where it is none. */
export function pairId(ends: readonly [PlaceName, PlaceName], drives: readonly { name: string; numPlaces: number }[]): string | { obstacle: string } {
  const orderOf = ({ drive }: PlaceName) => drives.findIndex(({ name }) => name === drive);
  for (const end of ends) {
    const of = drives[orderOf(end)];
    if (!of || !Number.isInteger(end.index) || end.index < 0 || end.index >= of.numPlaces)
      return { obstacle: `The places of ${end.drive} are numbered 0 to ${(of?.numPlaces ?? 1) - 1}.` };
  }
  const [a, b] = [...ends].sort((one, other) => orderOf(one) - orderOf(other) || one.index - other.index) as [PlaceName, PlaceName];
  if (a.drive !== b.drive) return `${a.drive}:${a.index}~${b.drive}:${b.index}`;
  return a.index === b.index ? { obstacle: 'Choose two different places.' } : `${a.drive}:${a.index}-${b.index}`;
}

/** The two places in the name of a loop or a link; a drive's name may hold anything. */
export function placesOf(id: string): { a: PlaceName; b: PlaceName } | null {
  const loop = /^(.*):(\d+)-(\d+)$/.exec(id);
  if (loop) return { a: { drive: loop[1]!, index: Number(loop[2]) }, b: { drive: loop[1]!, index: Number(loop[3]) } };
  const link = /^(.*):(\d+)~(.*):(\d+)$/.exec(id);
  return link && { a: { drive: link[1]!, index: Number(link[2]) }, b: { drive: link[3]!, index: Number(link[4]) } };
}

function isLink(id: string): boolean {
  const places = placesOf(id);
  return places !== null && places.a.drive !== places.b.drive;
}

const keyOf = (map: Pick<Schemas['Map'], 'site' | 'version'>) => `parkade.loops.${map.site}.${map.version}`;

interface Draft {
  decisions: Decision[];
  job: string | null; // that builds with them
}

/** What this browser keeps about a version; empty where that is nothing or cannot be read. */
export function readDraft(map: Pick<Schemas['Map'], 'site' | 'version'>, storage: Storage = localStorage): Draft {
  try {
    const kept = JSON.parse(storage.getItem(keyOf(map)) ?? '{}') as Partial<Draft> | null;
    const decisions = Array.isArray(kept?.decisions) ? kept.decisions.filter(({ id, verdict }) => typeof id === 'string' && kVerdicts.includes(verdict)) : [];
    return { decisions, job: typeof kept?.job === 'string' ? kept.job : null };
  } catch {
    return { decisions: [], job: null };
  }
}

export function keepDraft(map: Pick<Schemas['Map'], 'site' | 'version'>, draft: Draft, storage: Storage = localStorage): void {
  if (draft.decisions.length === 0 && draft.job === null) storage.removeItem(keyOf(map));
  else storage.setItem(keyOf(map), JSON.stringify(draft));
}

const kVerdicts: readonly Verdict[] = ['accept', 'reject', 'force'];
