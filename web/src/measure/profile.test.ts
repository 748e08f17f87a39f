import { expect, test } from 'vitest';

import type { Vector } from '../api/types';
import { placesAlong, profileCsv, profileOf, summaryOf } from './profile';

test('places lie evenly along all legs of a line, its ends included', () => {
  const places = placesAlong([[0, 0, 0], [1, 0, 0], [1, 2, 4]], 0.5);
  expect(places.map(({ along }) => along)).toEqual([0, 0.5, 1, 1.5, 2, 2.5, 3]);
  expect(places.map(({ point }) => point)).toEqual([
    [0, 0, 0], [0.5, 0, 0], [1, 0, 0], [1, 0.5, 1], [1, 1, 2], [1, 1.5, 3], [1, 2, 4],
  ]);
  expect(placesAlong([[0, 0, 0], [0, 0, 5]], 0.5)).toEqual([]);
  expect(placesAlong([[0, 0, 0]], 0.5)).toEqual([]);
});

test('long lines have no more stations than a plot can show', () => {
  const count = profileOf([[0, 0, 0], [5000, 0, 0]], () => 0).length;
  expect(count).toBeGreaterThan(300);
  expect(count).toBeLessThan(450);
});

test('a profile stays on the deck that it began on', () => {
  const decks = [0, 3]; // a ramp of 10 percent, twice
  const groundAt = (x: number, _y: number, height: number) =>
    decks.map((deck) => deck + 0.1 * x).find((ground) => ground < height + 1 && ground > height - 1.5) ?? null;
  const profile = profileOf([[0, 0, 0], [40, 0, 0.2]], groundAt); // drawn too low at its end
  expect(profile.every(({ isGround, point: [x, , z] }) => isGround && Math.abs(z - 0.1 * x) < 1e-9)).toBe(true);
});

test('where there is no ground, the profile has a gap', () => {
  const profile = profileOf([[0, 0, 5], [10, 0, 5]], (x) => (x > 4 && x < 6 ? null : 5 + 0.02 * x));
  expect(profile.some(({ isGround }) => !isGround)).toBe(true);
  const summary = summaryOf(profile)!;
  expect(summary.low).toBeCloseTo(5);
  expect(summary.high).toBeCloseTo(5.2);
  expect(summary.rise).toBeCloseTo(0.2);
  expect(summary.steepest).toBeCloseTo(2);
  expect(summaryOf(profileOf([[0, 0, 5], [10, 0, 5]], () => null))).toBeNull();
});

test('a curb is no slope of a car', () => {
  const curb = summaryOf(profileOf([[0, 0, 0], [10, 0, 0]], (x) => (x < 5 ? 0 : -0.1)))!;
  expect(curb.steepest).toBeCloseTo(-4, 1); // 10 cm in a wheelbase
});

test('a profile is a table', () => {
  const line: [Vector, Vector] = [[0, 0, 1], [0.1, 0, 1]];
  const profile = profileOf(line, (x) => (x < 0.08 ? 1.25 : null));
  expect(profileCsv(profile, null).split('\r\n')).toEqual([
    'along_m,x_m,y_m,ground_m', '0.000,0.000,0.000,1.250', '0.050,0.050,0.000,1.250', '0.100,0.100,0.000,', '',
  ]);
  expect(profileCsv(profile, ([, , z]) => [11.5, 48.1, 500 + z]).split('\r\n')[1]).toBe(
    '0.000,0.000,0.000,1.250,48.100000000,11.500000000,501.250',
  );
});
