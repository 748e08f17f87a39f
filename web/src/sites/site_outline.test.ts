import { expect, test } from 'vitest';

import { boxOf, middleOf, outlineOf } from './site_outline';

const datum = { latitude_deg: 48, longitude_deg: 11, altitude: 500 };
const bounds = { min: [-10, -20, 0], max: [30, 20, 3] } as { min: [number, number, number]; max: [number, number, number] };

test('an outline is the box about the map, on Earth', () => {
  const outline = outlineOf({ datum, bounds })!;
  expect(outline).toHaveLength(5);
  expect(outline[0]).toEqual(outline[4]);
  const [west, south, east, north] = boxOf([outline])!;
  // A degree of latitude is 111.2 km there, one of longitude 74.6 km.
  expect((east - west) * 74.63e3).toBeCloseTo(40, 0);
  expect((north - south) * 111.2e3).toBeCloseTo(40, 0);
  expect(middleOf(outline)[0]).toBeCloseTo(11 + 10 / 74.63e3, 6);
});

test('a site that is not on Earth, or has no map, has none', () => {
  expect(outlineOf({ datum: null, bounds })).toBeNull();
  expect(outlineOf({ datum, bounds: null })).toBeNull();
  expect(boxOf([])).toBeNull();
});
