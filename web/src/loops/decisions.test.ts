import { expect, test } from 'vitest';

import { changesIn, decide, effectOf, keepDraft, pairId, placesOf, readDraft, requestFor, undo, type Decision } from './decisions';
import type { Evidence } from './evidence';

const item = (id: string, isAccepted: boolean, kind: Evidence['kind'] = 'loop') => ({ id, kind, isAccepted }) as Evidence;
const all = [item('a:1-9', true), item('a:2-8', false), item('a:1~b:1', true, 'link'), item('a:2~b:2', false, 'link')];
const nothing = { from: 4, reject_loops: [], force_loops: [], reject_links: [], force_links: [] };

function storage(): Storage {
  const kept = new Map<string, string>();
  return {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => void kept.set(key, value),
    removeItem: (key: string) => void kept.delete(key),
    get length() {
      return kept.size;
    },
  } as unknown as Storage;
}

test('the last decision about an item counts', () => {
  let decisions: Decision[] = decide([], 'a:1-9', 'reject');
  decisions = decide(decisions, 'a:2-8', 'accept');
  decisions = decide(decisions, 'a:1-9', 'accept');
  expect(decisions).toEqual([{ id: 'a:2-8', verdict: 'accept' }, { id: 'a:1-9', verdict: 'accept' }]);
  expect(undo(decisions, 'a:2-8')).toEqual([{ id: 'a:1-9', verdict: 'accept' }]);
});

test('only what differs from the version is sent, loops and links apart', () => {
  const decided = (...verdicts: [string, Decision['verdict']][]) => requestFor(verdicts.map(([id, verdict]) => ({ id, verdict })), all, 4);
  expect(decided(['a:1-9', 'accept'], ['a:2-8', 'reject'], ['a:1~b:1', 'accept'], ['a:2~b:2', 'reject'])).toEqual(nothing);
  expect(decided(['a:1~b:1', 'reject'], ['a:2~b:2', 'accept'])).toEqual({ ...nothing, reject_links: ['a:1~b:1'], force_links: ['a:2~b:2'] });
  const wanted = decided(['a:1-9', 'reject'], ['a:2-8', 'accept'], ['a:3-7', 'force']);
  expect(wanted).toEqual({ ...nothing, reject_loops: ['a:1-9'], force_loops: ['a:2-8', 'a:3-7'] });
  expect(changesIn(wanted)).toBe(3);
  expect(decided(['a:5~b:6', 'force'])).toEqual({ ...nothing, force_links: ['a:5~b:6'] });
});

test('words for what a decision does', () => {
  expect(effectOf({ id: 'a:1-9', verdict: 'reject' }, all[0])).toBe('is left out');
  expect(effectOf({ id: 'a:2-8', verdict: 'accept' }, all[1])).toBe('is forced');
  expect(effectOf({ id: 'a:1~b:1', verdict: 'reject' }, all[2])).toBe('is left out');
  expect(effectOf({ id: 'a:5-6', verdict: 'force' }, undefined)).toBe('is forced');
});

test('a pair is named as the service names it', () => {
  const drives = [{ name: 'b', numPlaces: 5 }, { name: 'a:b', numPlaces: 18 }];
  const at = (drive: string, index: number) => ({ drive, index });
  expect(pairId([at('a:b', 9), at('a:b', 3)], drives)).toBe('a:b:3-9');
  expect(placesOf('a:b:3-9')).toEqual({ a: at('a:b', 3), b: at('a:b', 9) });
  expect(pairId([at('a:b', 9), at('b', 4)], drives)).toBe('b:4~a:b:9');
  expect(placesOf('b:4~a:b:9')).toEqual({ a: at('b', 4), b: at('a:b', 9) });
  expect(placesOf('nothing')).toBeNull();
  expect(pairId([at('b', 3), at('b', 3)], drives)).toEqual({ obstacle: 'Choose two different places.' });
  for (const bad of [-1, 18, 2.5, NaN]) expect(pairId([at('b', 1), at('a:b', bad)], drives)).toEqual({ obstacle: 'The places of a:b are numbered 0 to 17.' });
});

test('a draft is kept by site and version, and a broken one is none', () => {
  const place = storage();
  const draft = { decisions: [{ id: 'a:1-9', verdict: 'reject' as const }], job: 'f00' };
  keepDraft({ site: 'lot', version: 2 }, draft, place);
  expect(readDraft({ site: 'lot', version: 2 }, place)).toEqual(draft);
  expect(readDraft({ site: 'lot', version: 1 }, place)).toEqual({ decisions: [], job: null });
  keepDraft({ site: 'lot', version: 2 }, { decisions: [], job: null }, place);
  expect(place.length).toBe(0);
  for (const text of ['{', 'null', '7', '{"decisions": [{"id": 3, "verdict": "reject"}, {"id": "x", "verdict": "burn"}]}']) {
    place.setItem('parkade.loops.lot.2', text);
    expect(readDraft({ site: 'lot', version: 2 }, place)).toEqual({ decisions: [], job: null });
  }
});
