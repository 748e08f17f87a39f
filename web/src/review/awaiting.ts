// What awaits a reviewer over all sites. No page in here.

import type { ListedMap, Site } from '../api/types';

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
export function queueOf(sites: readonly Site[], maps: readonly ListedMap[]): Queue {
  const known = new Map(sites.map((site) => [site.name, site]));
  const queue: Queue = { inReview: [], drafts: [], olderDrafts: [] };
  for (const map of maps) {
    if (map.files_deleted_at !== null) continue;
    const site = known.get(map.site);
    const awaited = { map, approved: site?.approved_version ?? null };
    if (map.review_state === 'in_review') queue.inReview.push(awaited);
    else if (map.review_state === 'draft') (map.version === site?.latest_version ? queue.drafts : queue.olderDrafts).push(awaited);
  }
  for (const list of Object.values(queue) as Awaited[][]) list.sort(byNewest);
  return queue;
}
