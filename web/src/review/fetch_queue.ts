// What awaits a reviewer, asked from the service.

import { request } from '../api/client';
import { listMaps, listSites } from '../api/lists';
import type { Job } from '../api/types';
import { inTurns, openThreads, queueOf, versionsTalkedAbout, type OpenThread, type Queue, type SiteVersions } from './awaiting';
import { fetchComments } from './fetch_review';
import { threadsOf } from './threads';

const kAtOnce = 6; // as many as a browser sends to one server

async function fetchSites(): Promise<SiteVersions[]> {
  const sites = await listSites();
  return inTurns(sites.filter(({ versions }) => versions.length > 0), kAtOnce, async (site) => ({ site, versions: await listMaps(site.name) }));
}

export interface Awaiting {
  queue: Queue;
  threads: OpenThread[];
}

export async function fetchAwaiting(): Promise<Awaiting> {
  const sites = await fetchSites();
  const found = await inTurns(versionsTalkedAbout(sites), kAtOnce, async (map) => ({ map, threads: threadsOf(await fetchComments(map)) }));
  return { queue: queueOf(sites), threads: openThreads(found) };
}

/** The latest that failed, of the last hundred jobs. */
export async function fetchFailedJobs(most: number): Promise<Job[]> {
  const { items } = await request('get', '/api/v1/jobs', { query: { limit: 100 } });
  return items.filter(({ state }) => state === 'failed').slice(0, most);
}
