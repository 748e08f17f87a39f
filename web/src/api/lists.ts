// Lists that the service answers page by page, whole.

import { request } from './client';

interface Page<Item> {
  items: Item[];
  next_cursor: string | null;
}

/** All pages of a list, newest first. */
export async function all<Item>(
  pageAfter: (query: { limit: number; cursor?: string }) => Promise<Page<Item>>,
): Promise<Item[]> {
  const items: Item[] = [];
  let cursor: string | null = null;
  do {
    const page: Page<Item> = await pageAfter({ limit: 100, ...(cursor === null ? {} : { cursor }) });
    items.push(...page.items);
    cursor = page.next_cursor;
  } while (cursor !== null);
  return items;
}

export const listDrives = () => all((query) => request('get', '/api/v1/drives', { query }));
export const listSites = () => all((query) => request('get', '/api/v1/sites', { query }));
export const listJobs = () => all((query) => request('get', '/api/v1/jobs', { query }));
export const listRigs = () => all((query) => request('get', '/api/v1/rigs', { query }));
export const listMaps = (site: string) =>
  all((query) => request('get', '/api/v1/sites/{site}/maps', { path: { site }, query }));
