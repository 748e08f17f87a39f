// The review state of each site's latest version.

import { request } from '../api/client';
import { listSites } from '../api/lists';
import type { ReviewState } from '../api/types';

const kAtOnce = 6;

/** By the name of the site; one that cannot be asked for is left out. */
export async function fetchReviewStates(): Promise<Map<string, ReviewState>> {
  const ahead = (await listSites()).filter(({ latest_version }) => latest_version !== null);
  const states = new Map<string, ReviewState>();
  const ask = async () => {
    for (let site = ahead.shift(); site; site = ahead.shift()) {
      const path = { site: site.name, version: String(site.latest_version) };
      const review = await request('get', '/api/v1/sites/{site}/maps/{version}/review', { path }).catch(() => null);
      if (review) states.set(site.name, review.state);
    }
  };
  await Promise.all(Array.from({ length: kAtOnce }, ask));
  return states;
}
