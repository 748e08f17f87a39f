import { expect, test } from 'vitest';

import { decksOf, floorOf, sliceOf } from './decks';

const sheet = (level: number, low: number, high: number, mean: number, area_m2 = 100) => ({
  properties: { level, area_m2, min_height_m: low, max_height_m: high, mean_height_m: mean },
  geometry: { type: 'Polygon' as const, coordinates: [] },
});

test('sheets of a level are one deck, the lowest first', () => {
  const decks = decksOf({ features: [sheet(1, 2.5, 3.1, 3), sheet(0, -0.2, 0.4, 0, 300), sheet(0, 0.1, 1, 0.4, 100)] });
  expect(decks.map(({ level }) => level)).toEqual([0, 1]);
  expect(decks[0]).toEqual({ level: 0, low: -0.2, high: 1, mean: 0.1, area: 400 });
});

test('a slice holds a deck, its ramp and what drives on it, and not the decks beside it', () => {
  const decks = decksOf({ features: [sheet(0, -1.56, -0.62, -1.53), sheet(1, -0.62, 1.62, 1.5)] });
  const [lower, upper] = [sliceOf(decks, 0)!, sliceOf(decks, 1)!];
  expect(lower.low).toBeLessThan(-1.56);
  expect(lower.high).toBeGreaterThan(-0.62);
  expect(lower.high).toBeLessThan(1.4); // the floor above
  expect(upper.low).toBeLessThan(0); // most of the ramp
  expect(upper.low).toBeGreaterThan(-1.53 + 1); // cameras on the floor below
  expect(upper.high).toBeGreaterThan(1.62 + 1);
  expect(sliceOf(decks, 7)).toBeNull();
});

test('a deck that slopes past the next one still shows its mean', () => {
  const decks = decksOf({ features: [sheet(0, 0, 4, 2), sheet(1, 1, 5, 2.5)] });
  const slice = sliceOf(decks, 0)!;
  expect(slice.low).toBeLessThan(2);
  expect(slice.high).toBeGreaterThan(2);
});

test('the colors of a deck are for its floor, not for the ramp that leads to it', () => {
  const floor = floorOf({ level: 1, low: -0.6, high: 1.62, mean: 1.5, area: 1 });
  expect(floor.low).toBeCloseTo(1.26);
  expect(floor.high).toBeCloseTo(1.62);
});
