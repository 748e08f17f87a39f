import { expect, test } from 'vitest';

import type { ListedMap, Site } from '../api/types';
import { queueOf } from './awaiting';

function version(site: string, number: number, state: ListedMap['review_state'], change: Partial<ListedMap> = {}): ListedMap {
  return {
    site, version: number, job: 'j', sha256: '', datum: null, bounds: null, created_at: `2026-01-0${number}T00:00:00Z`, url: '',
    review_state: state, files_deleted_at: null, ...change,
  };
}
const site = (name: string, latest: number | null, approved: number | null) => ({ name, latest_version: latest, approved_version: approved }) as Site;

test('what awaits comes newest first, superseded drafts apart', () => {
  const { inReview, drafts, olderDrafts } = queueOf(
    [site('lot', 4, 1), site('deck', 5, null), site('new', null, null)],
    [
      version('lot', 2, 'in_review'), version('deck', 5, 'in_review'), version('lot', 3, 'draft'), version('lot', 4, 'draft'), version('lot', 1, 'approved'),
      version('deck', 4, 'draft', { files_deleted_at: '2026-02-01T00:00:00Z' }),
    ],
  );
  const names = (list: typeof inReview) => list.map(({ map, approved }) => `${map.site}/${map.version} against ${approved}`);
  expect(names(inReview)).toEqual(['deck/5 against null', 'lot/2 against 1']);
  expect(names(drafts)).toEqual(['lot/4 against 1']);
  expect(names(olderDrafts)).toEqual(['lot/3 against 1']);
});
