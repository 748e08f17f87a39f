import { expect, test } from 'vitest';

import { selectionOfText, textOfSelection } from './selection_text';
import type { Selection } from './workspace.svelte';

test('what is chosen comes back from its text', () => {
  const chosen: Selection[] = [
    { kind: 'point', point: [1, -2.5, 0] },
    { kind: 'slot', id: 'L1-07', point: [12.3, -4, 0.1] },
    { kind: 'loop', id: 'day1:3-9', point: [0, 0, 0] },
    { kind: 'comment', id: 'c1', point: null },
    { kind: 'measurement', id: 'm1', point: [1, 2, 3] },
  ];
  for (const selection of chosen) expect(selectionOfText(textOfSelection(selection))).toEqual(selection);
});

test('other texts choose nothing', () => {
  for (const text of [null, '', 'slot', 'slot:@1,2,3', 'slot:7', 'slot:7@1,2', 'slot:7@1,2,x', 'car:7@1,2,3', 'comment:', 'point:'])
    expect(selectionOfText(text)).toBeNull();
});
