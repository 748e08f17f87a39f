import { expect, test } from 'vitest';

import { itemsIn, itemsOfText, noteWith, wordsOfTicks } from './checklist';

const kNote = 'Gate code 17.\n\nReview checklist:\n- Ramps driven both ways\n-  Charging bays named \n\nCall Ann first.';

test('a note holds the list below its heading', () => {
  expect(itemsIn(kNote)).toEqual(['Ramps driven both ways', 'Charging bays named']);
  expect(itemsIn('- not a list of checks')).toBeNull();
  expect(itemsIn('Review checklist:\n\n- too late')).toBeNull();
  expect(itemsIn('')).toBeNull();
});

test('what else a note says stays', () => {
  expect(noteWith(kNote, ['One'])).toBe('Gate code 17.\n\nCall Ann first.\n\nReview checklist:\n- One');
  expect(noteWith(kNote, [])).toBe('Gate code 17.\n\nCall Ann first.');
  expect(noteWith('', ['One', 'Two'])).toBe('Review checklist:\n- One\n- Two');
  expect(itemsIn(noteWith(kNote, ['One', 'Two']))).toEqual(['One', 'Two']);
});

test('typed lines are items, each once', () => {
  expect(itemsOfText(' One\n\n- Two\nOne ')).toEqual(['One', 'Two']);
});

test('ticks are said in the reason', () => {
  expect(wordsOfTicks(['One', 'Two'], (item) => item === 'Two')).toBe('[ ] One\n[x] Two');
});
