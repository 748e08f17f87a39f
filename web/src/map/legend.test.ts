import { expect, test } from 'vitest';

import { ticksOf } from './legend';

test('ticks have the digits that tell them apart', () => {
  expect(ticksOf(-1.7125, -1.2087, 'm')).toEqual(['-1.71 m', '-1.46 m', '-1.21 m']);
  expect(ticksOf(-1.58, -1.42, 'm')[1]).toBe('-1.50 m');
  expect(ticksOf(330, 331, 'd')).toEqual(['330.0 d', '330.5 d', '331.0 d']);
  expect(ticksOf(0, 16, '%')).toEqual(['0 %', '8 %', '16 %']);
  expect(ticksOf(0, 0.08, 'm')).toEqual(['0.00 m', '0.04 m', '0.08 m']);
  expect(ticksOf(-0.01, 0.01, 'm')[1]).toBe('0.00 m');
});
