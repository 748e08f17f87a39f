import { expect, test } from 'vitest';

import type { Comment } from '../api/types';
import { inOrder, pinOfSelection, threadsOf, wordsOfPin } from './threads';

function comment(id: string, change: Partial<Comment> = {}): Comment {
  return {
    id, site: 'lot', version: 2, thread: null, text: id, pin: null, author: 'ann', created_at: '2026-01-01T10:00:00Z',
    edited_at: null, resolved_at: null, resolved_by: null, deleted: false, ...change,
  };
}

test('answers belong to the comment that they answer, oldest first', () => {
  const threads = threadsOf([
    comment('late', { thread: 'old', created_at: '2026-01-03T00:00:00Z' }),
    comment('new', { created_at: '2026-01-02T00:00:00Z' }),
    comment('early', { thread: 'old', created_at: '2026-01-02T00:00:00Z' }),
    comment('old'),
  ]);
  expect(threads.map(({ number, first, answers }) => [number, first.id, answers.map(({ id }) => id)])).toEqual([
    [1, 'old', ['early', 'late']],
    [2, 'new', []],
  ]);
});

test('a list begins with what is open, newest first, and numbers stay', () => {
  const days = ['a', 'b', 'c', 'd'].map((id, i) =>
    comment(id, { created_at: `2026-01-0${i + 1}T00:00:00Z`, resolved_at: id === 'd' || id === 'a' ? '2026-01-09T00:00:00Z' : null }),
  );
  expect(inOrder(threadsOf(days)).map(({ number }) => number)).toEqual([3, 2, 4, 1]);
});

test('a comment is pinned to what is chosen', () => {
  expect(pinOfSelection({ kind: 'slot', id: 'slot_1', point: [0, 0, 0] })).toEqual({ slot: 'slot_1' });
  expect(pinOfSelection({ kind: 'loop', id: 'day1:17-140', point: [0, 0, 0] })).toEqual({ loop: 'day1:17-140' });
  expect(pinOfSelection({ kind: 'point', point: [1, 2, 3] })).toEqual({ point: [1, 2, 3] });
  expect(pinOfSelection({ kind: 'comment', id: 'x', point: null })).toBeNull();
  expect(pinOfSelection(null)).toBeNull();
});

test('pins are said in words', () => {
  const words = (pin: Parameters<typeof wordsOfPin>[0], start: number | null = 1000) => wordsOfPin(pin, () => 'day1', () => start);
  expect(words({ point: [1.26, -2, 0.04] })).toBe('at 1.3, -2.0, 0.0 m');
  expect(words({ slot: 'slot_2419d4eac1' })).toBe('slot 2419d4eac1');
  expect(words({ loop: 'day1:17-140' })).toBe('loop day1:17-140');
  expect(words({ drive: 'x', time: 1003.25 })).toBe('day1 at 3.3 s');
  expect(words({ drive: 'x', time: 1003.25 }, null)).toBe('day1');
  expect(words({})).toBe('the whole version');
  expect(words(null)).toBe('the whole version');
});
