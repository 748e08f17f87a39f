import { expect, test } from 'vitest';

import type { ListedMap, Site } from '../api/types';
import { inTurns, openThreads, queueOf, versionsTalkedAbout } from './awaiting';
import type { Thread } from './threads';

function version(site: string, number: number, state: ListedMap['review_state'], change: Partial<ListedMap> = {}): ListedMap {
  return {
    site, version: number, job: 'j', sha256: '', datum: null, bounds: null, created_at: `2026-01-0${number}T00:00:00Z`, url: '',
    review_state: state, files_deleted_at: null, ...change,
  };
}
const site = (name: string, approved: number | null) => ({ name, approved_version: approved }) as Site;

const kSites = [
  { site: site('lot', 1), versions: [version('lot', 4, 'draft'), version('lot', 3, 'draft'), version('lot', 2, 'in_review'), version('lot', 1, 'approved')] },
  { site: site('deck', null), versions: [version('deck', 5, 'in_review'), version('deck', 4, 'draft', { files_deleted_at: '2026-02-01T00:00:00Z' })] },
  { site: site('new', null), versions: [] },
];

test('what awaits comes newest first, superseded drafts apart', () => {
  const { inReview, drafts, olderDrafts } = queueOf(kSites);
  const names = (list: typeof inReview) => list.map(({ map, approved }) => `${map.site}/${map.version} against ${approved}`);
  expect(names(inReview)).toEqual(['deck/5 against null', 'lot/2 against 1']);
  expect(names(drafts)).toEqual(['lot/4 against 1']);
  expect(names(olderDrafts)).toEqual(['lot/3 against 1']);
});

test('comments are read where they matter', () => {
  expect(versionsTalkedAbout(kSites).map(({ site: name, version: number }) => `${name}/${number}`)).toEqual(['lot/4', 'lot/3', 'lot/2', 'lot/1', 'deck/5']);
});

test('threads are sorted by what was said last', () => {
  const thread = (id: string, day: number, answer: number | null, isOpen = true) =>
    ({ number: 1, isOpen, first: { id, created_at: `2026-01-0${day}` }, answers: answer === null ? [] : [{ created_at: `2026-01-0${answer}` }] }) as Thread;
  const found = openThreads([
    { map: kSites[0]!.versions[0]!, threads: [thread('a', 1, 9), thread('b', 5, null)] },
    { map: kSites[1]!.versions[0]!, threads: [thread('c', 7, null), thread('d', 8, null, false)] },
  ]);
  expect(found.map(({ thread: { first } }) => first.id)).toEqual(['a', 'c', 'b']);
});

test('a few at a time, in order', async () => {
  let [running, most] = [0, 0];
  const run = async (value: number) => {
    most = Math.max(most, ++running);
    await new Promise((resolve) => setTimeout(resolve, 5 - value));
    running -= 1;
    return 10 * value;
  };
  expect(await inTurns([1, 2, 3, 4], 2, run)).toEqual([10, 20, 30, 40]);
  expect(most).toBe(2);
  expect(await inTurns([], 2, run)).toEqual([]);
  await expect(inTurns([1, 2], 2, () => Promise.reject(new Error('no')))).rejects.toThrow('no');
});
