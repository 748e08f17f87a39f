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

test('links between drives are found by both of their places, where the map says when those were', () => {
  const links = [{ place_a: 1, place_b: 7, time_a: 10, time_b: 70 }, { place_a: 2, place_b: 8 }];
  const report = { drives: [], join: { pairs: [{ a: 'day1', b: 'day2', links }] } };
  expect(timeOfLoop(report, 'day1:1~day2:7')).toEqual({ drive: 'day2', time: 70 });
  expect(timeOfLoop(report, 'day1:2~day2:8')).toBeNull();
  expect(timeOfLoop(report, 'day1:7~day2:1')).toBeNull();
});
