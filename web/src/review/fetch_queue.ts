// What awaits a reviewer, asked from the service.

import { request, type Schemas } from '../api/client';
import { all, listSites } from '../api/lists';
import type { Job } from '../api/types';
import { queueOf, type Queue } from './awaiting';

export interface Awaiting {
  queue: Queue;
  /** Open threads on versions that are not rejected; those that something was said in last come first. */
  threads: Schemas['CommentThread'][];
  hasMoreThreads: boolean;
}

export async function fetchAwaiting(mostThreads: number): Promise<Awaiting> {
  const [sites, maps, threads] = await Promise.all([
    listSites(),
    all((query) => request('get', '/api/v1/maps', { query: { ...query, review_state: 'draft,in_review' } })),
    request('get', '/api/v1/comments', { query: { limit: mostThreads, resolved: false, review_state: 'draft,in_review,approved' } }),
  ]);
  return { queue: queueOf(sites, maps), threads: threads.items, hasMoreThreads: threads.next_cursor !== null };
}

/** The latest that failed. */
export async function fetchFailedJobs(most: number): Promise<Job[]> {
  return (await request('get', '/api/v1/jobs', { query: { limit: most, state: 'failed' } })).items;
}
