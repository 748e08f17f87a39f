import { expect, test } from 'vitest';

import type { Drive, Job, Site } from '../api/types';
import { isWanted, rowsOf } from './site_rows';

const site = (name: string, more: Partial<Site> = {}) =>
  ({ name, title: '', note: '', latest_version: 1, created_at: '2026-01-01', ...more }) as Site;
const rows = rowsOf(
  [site('lot', { title: 'The big one', review_state: 'approved' }), site('garage', { review_state: 'in_review' }), site('new', { latest_version: null, created_at: '2026-02-15' })],
  [{ site: 'garage', created_at: '2026-03-01' }, { site: 'lot', created_at: '2026-02-01' }, { site: 'garage', created_at: '2026-01-05' }] as Drive[],
  [{ id: 'b', site: 'lot', state: 'queued' }, { id: 'a', site: 'lot', state: 'running' }, { id: 'c', site: 'garage', state: 'done' }] as Job[],
);
const wanted = (text: string, filter: string) => rows.filter((row) => isWanted(row, text, filter)).map((row) => row.site.name);

test('the newest drive comes first, and what runs is told from what has ended', () => {
  expect(rows.map((row) => [row.site.name, row.lastDrive, row.job?.id ?? null])).toEqual([
    ['garage', '2026-03-01', null],
    ['new', null, null],
    ['lot', '2026-02-01', 'a'],
  ]);
});

test('all words must be found, in name, title or note', () => {
  expect(wanted('', '')).toEqual(['garage', 'new', 'lot']);
  expect(wanted('BIG lot', '')).toEqual(['lot']);
  expect(wanted('big garage', '')).toEqual([]);
});

test('filters', () => {
  expect(wanted('', 'approved')).toEqual(['lot']);
  expect(wanted('', 'in_review')).toEqual(['garage']);
  expect(wanted('', 'no_map')).toEqual(['new']);
  expect(wanted('', 'busy')).toEqual(['lot']);
  expect(wanted('garage', 'busy')).toEqual([]);
});
