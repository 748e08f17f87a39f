import { expect, test } from 'vitest';

import { itemsOfText, openOnes, wordsOfTicks, type ChecklistEntry } from './checklist';

const entry = (id: string, by: string | null): ChecklistEntry => ({ id, text: id, ticked_by: by, ticked_at: by && '2026-01-01T00:00:00Z' });

test('typed lines are items, each once; what stays keeps its id', () => {
  const before = [{ id: 'ramp', text: 'Ramps driven' }, { id: 'bay', text: 'Bays named' }];
  expect(itemsOfText(' Bays named\n\n- Ramps driven both ways\nBays named ', before)).toEqual([
    { id: 'bay', text: 'Bays named' },
    { text: 'Ramps driven both ways' }, // another thing to look at: nobody has ticked it
  ]);
  expect(itemsOfText(' \n', before)).toEqual([]);
});

test('what is open is told, and how much is done', () => {
  const entries = [entry('a', 'ann'), entry('b', null), entry('c', 'bob')];
  expect(openOnes(entries).map(({ id }) => id)).toEqual(['b']);
  expect(wordsOfTicks(entries)).toBe('2 of 3 ticked');
  expect(wordsOfTicks([])).toBe('no checklist');
});
