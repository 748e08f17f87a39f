// What the list of sites shows of each, and which of them are wanted.

import type { Drive, Job, Site } from '../api/types';

export interface SiteRow {
  site: Site;
  lastDrive: string | null; // when the newest one was uploaded
  job: Job | null; // that runs, or waits
}

export const kFilters = ['draft', 'in_review', 'approved', 'rejected', 'no_map', 'busy'] as const;
export type Filter = (typeof kFilters)[number];

/** The site that was changed last comes first: by its newest drive. */
export function rowsOf(
  sites: readonly Site[],
  drives: readonly Drive[],
  jobs: readonly Job[],
): SiteRow[] {
  const lastDrives = new Map<string, string>();
  for (const { site, created_at } of drives)
    if (created_at > (lastDrives.get(site) ?? '')) lastDrives.set(site, created_at);
  const busy = new Map<string, Job>();
  for (const job of jobs) {
    if (job.state === 'running') busy.set(job.site, job);
    else if (job.state === 'queued' && !busy.has(job.site)) busy.set(job.site, job);
  }
  return sites
    .map((site) => ({
      site,
      lastDrive: lastDrives.get(site.name) ?? null,
      job: busy.get(site.name) ?? null,
    }))
    .sort((a, b) => (b.lastDrive ?? b.site.created_at).localeCompare(a.lastDrive ?? a.site.created_at));
}

export function isWanted({ site, job }: SiteRow, text: string, filter: string): boolean {
  const words = text.toLowerCase().split(/\s+/).filter((word) => word !== '');
  const about = `${site.name} ${site.title} ${site.note}`.toLowerCase();
  if (!words.every((word) => about.includes(word))) return false;
  switch (filter) {
    case '': return true;
    case 'no_map': return site.latest_version === null;
    case 'busy': return job !== null;
    default: return site.review_state === filter;
  }
}
