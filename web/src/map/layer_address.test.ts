import { expect, test } from 'vitest';

import { groundColorOfText, layersOfText, pathColorOfText, sliceOfText, textOfLayers, textOfSlice, usualLayers } from './layer_address';

test('an address holds only what differs from the usual', () => {
  expect(textOfLayers(usualLayers())).toBeNull();
  const shown = { ...usualLayers(), slots: false, links: true };
  expect(textOfLayers(shown)).toBe('-slots,links');
  expect(layersOfText('-slots,links')).toEqual(shown);
});

test('what nobody knows is passed over', () => {
  expect(layersOfText('-walls,__proto__,slots')).toEqual(usualLayers());
  expect(layersOfText(null)).toEqual(usualLayers());
  expect(groundColorOfText('mood')).toBe('picture');
  expect(groundColorOfText('sigma')).toBe('sigma');
  expect(pathColorOfText('gnss')).toBe('gnss');
  expect(pathColorOfText(null)).toBe('drive');
});

test('slices go there and back', () => {
  expect(sliceOfText(textOfSlice({ low: -1.5, high: 2 }))).toEqual({ low: -1.5, high: 2 });
  for (const text of [null, '', '1', '2,1', 'a,b', '1,2,3', ',']) expect(sliceOfText(text)).toBeNull();
});
