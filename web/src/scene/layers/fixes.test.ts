import { expect, test } from 'vitest';

import type { Schemas } from '../../api/client';
import { fixesOf, fixesShownBy, makeFixes, nearestFix } from './fixes';

const file = {
  start: '100.000000000', max_sigma: 10,
  fixes: [
    { time: 1, position: [0, 0, 2], sigma: [1, 1, 2], state: 'used', error: 0.4, error_up: -0.1 },
    { time: 2, position: [10, 0, 2], sigma: [1, 1, 2], state: 'outlier', error: 9, error_up: 0 },
    { time: 3, position: [20, 0, 2], sigma: [60, 60, null], state: 'vague' },
  ],
} as Schemas['GnssFixes'];
const fixes = fixesOf('day1', file);

test('used ones are discs, all others crosses', () => {
  const objects = makeFixes(fixes);
  expect(objects.map((object) => fixesShownBy(object).map(({ state }) => state))).toEqual([['outlier', 'vague'], ['used']]);
  expect(makeFixes([])).toEqual([]);
  const [crosses, discs] = objects as unknown as { material: { map: { image: { data: Uint8Array } } } }[];
  const middle = (of: typeof crosses) => of!.material.map.image.data[4 * (16 * 32 + 2) + 3];
  expect([middle(discs), middle(crosses)]).toEqual([0, 0]); // nothing at the edge of a row's middle
  expect(discs!.material.map.image.data[4 * (16 * 32 + 16) + 3]).toBe(255);
  expect(discs!.material.map.image.data).not.toEqual(crosses!.material.map.image.data);
});

test('the nearest point in the picture is found, and none that is far or behind', () => {
  const project = ([x, y]: [number, number, number]): [number, number] | null => (x > 15 ? null : [10 * x, y]);
  expect(nearestFix(fixes, [96, 3], 10, project)?.state).toBe('outlier');
  expect(nearestFix(fixes, [50, 0], 10, project)).toBeNull();
  expect(nearestFix(fixes, [200, 0], 10, project)).toBeNull();
});
