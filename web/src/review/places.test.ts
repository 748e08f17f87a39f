import { expect, test } from 'vitest';

import { timeOfLoop } from './places';

test('loops are found by drive and number', () => {
  const drive = (name: string, later: number) =>
    ({ name, length: 1, duration: 1, num_keyframes: 1, loops: { candidates: [{ place_a: 0, place_b: 0, id: '17-140', later }] } });
  const report = { drives: [drive('day1', 100), drive('a:b', 200)] };
  expect(timeOfLoop(report, '17-140')).toEqual({ drive: 'day1', time: 100 });
  expect(timeOfLoop(report, 'a:b:17-140')).toEqual({ drive: 'a:b', time: 200 });
  expect(timeOfLoop(report, 'day1:1-2')).toBeNull();
});
