// A review and its comments, whole.

import { request } from '../api/client';
import { all } from '../api/lists';
import type { Review } from '../api/types';

interface Version {
  site: string;
  version: number;
}

/** The state, and all of the history, newest first. */
export async function fetchReview({ site, version }: Version): Promise<Review> {
  let review: Review | null = null;
  const history = await all(async (query) => {
    const page = await request('get', '/api/v1/sites/{site}/maps/{version}/review', { path: { site, version: String(version) }, query });
    review ??= page;
    return { items: page.history, next_cursor: page.next_cursor };
  });
  return { ...review!, history, next_cursor: null };
}

export const fetchComments = ({ site, version }: Version) =>
  all((query) => request('get', '/api/v1/sites/{site}/maps/{version}/comments', { path: { site, version: String(version) }, query }));
