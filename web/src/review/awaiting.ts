// What awaits a reviewer over all sites. No page in here.

import type { ListedMap, Site } from '../api/types';
import type { Thread } from './threads';

export interface SiteVersions {
  site: Site;
  versions: ListedMap[];
}

export interface Awaited {
  map: ListedMap;
  /** The site's approved version, to compare with. */
  approved: number | null;
}

export interface Queue {
  inReview: Awaited[]; // newest first
  drafts: Awaited[]; // the newest version of each site, where it is one
  olderDrafts: Awaited[]; // a newer version of the site took their place
}

const byNewest = (a: Awaited, b: Awaited) => b.map.created_at.localeCompare(a.map.created_at);

/** Versions without files cannot be looked at any more: they await nothing. */
export function queueOf(sites: SiteVersions[]): Queue {
  const queue: Queue = { inReview: [], drafts: [], olderDrafts: [] };
  for (const { site, versions } of sites) {
    const newest = Math.max(...versions.map(({ version }) => version));
    for (const map of versions) {
      if (map.files_deleted_at !== null) continue;
      const awaited = { map, approved: site.approved_version };
      if (map.review_state === 'in_review') queue.inReview.push(awaited);
      else if (map.review_state === 'draft') (map.version === newest ? queue.drafts : queue.olderDrafts).push(awaited);
    }
  }
  for (const list of Object.values(queue) as Awaited[][]) list.sort(byNewest);
  return queue;
}

/** Versions whose comments are worth reading: those that await something, and the one that cars are steered by. */
export function versionsTalkedAbout(sites: SiteVersions[]): ListedMap[] {
  return sites.flatMap(({ site, versions }) =>
    versions.filter(
      ({ version, review_state: state, files_deleted_at: gone }) =>
        gone === null && (state === 'in_review' || state === 'draft' || version === site.approved_version),
    ),
  );
}

export interface OpenThread {
  site: string;
  version: number;
  thread: Thread;
  latest: string; // time of what was said last
}

/** Open threads of all versions, those that something was said in last first. */
export function openThreads(found: { map: ListedMap; threads: Thread[] }[]): OpenThread[] {
  return found
    .flatMap(({ map: { site, version }, threads }) =>
      threads
        .filter(({ isOpen }) => isOpen)
        .map((thread) => ({ site, version, thread, latest: thread.answers.at(-1)?.created_at ?? thread.first.created_at })),
    )
    .sort((a, b) => b.latest.localeCompare(a.latest));
}

/** Runs through a list, a few at a time; answers in the list's order. */
export async function inTurns<Item, Result>(items: Item[], atOnce: number, run: (item: Item) => Promise<Result>): Promise<Result[]> {
  const results: Result[] = [];
  let next = 0;
  const worker = async () => {
    while (next < items.length) {
      const at = next++;
      results[at] = await run(items[at]!);
    }
  };
  await Promise.all(Array.from({ length: Math.min(atOnce, items.length) }, worker));
  return results;
}
