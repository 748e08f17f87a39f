import { expect, test } from 'vitest';

import { textOfView, viewOfText } from './view_text';

test('a view survives its address', () => {
  const view = { position: [12.5, -30.25, 40] as [number, number, number], target: [1, 2, -1.5] as [number, number, number] };
  expect(viewOfText(textOfView(view))).toEqual(view);
});

test('what is no view is none', () => {
  for (const text of [null, '', '1,2,3', '1,2,3,4,5,x', '1,2,3,,5,6', '1,2,3,1,2,3', '1,2,3,4,5,6,7'])
    expect(viewOfText(text)).toBeNull();
});
