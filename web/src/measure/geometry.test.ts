import { describe, expect, test } from 'vitest';

import type { Vector } from '../api/types';
import { areaOf, centerOf, formatValue, lengthOf, runOf, slopeOf, valueOf } from './geometry';

const kSquare: Vector[] = [[1000, 2000, 1], [1004, 2000, 1], [1004, 2003, 5], [1000, 2003, 5]];

test('lengths are in space, runs are seen from above', () => {
  expect(lengthOf([[0, 0, 0], [3, 4, 0], [3, 4, 2]])).toBeCloseTo(7, 12);
  expect(runOf([[0, 0, 0], [3, 4, 0], [3, 4, 2]])).toBeCloseTo(5, 12);
  expect(lengthOf([[1, 1, 1]])).toBe(0);
});

test('an area is seen from above, whichever way it is drawn', () => {
  expect(areaOf(kSquare)).toBeCloseTo(12, 9);
  expect(areaOf([...kSquare].reverse())).toBeCloseTo(12, 9);
  expect(areaOf([[0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0]])).toBeCloseTo(10, 12); // a notch
  expect(areaOf(kSquare.slice(0, 2))).toBe(0);
  expect(areaOf([])).toBe(0);
});

test('the middle is that of what the points take up', () => {
  expect(centerOf([[0, 0, 1], [4, 0, 1], [4, 0, 1], [2, 6, 3]])).toEqual([2, 3, 2]);
});

test('a slope is rise per run, and none above itself', () => {
  expect(slopeOf([[0, 0, 1], [10, 0, 1.5]])).toBeCloseTo(5, 12);
  expect(slopeOf([[0, 0, 1], [0, 20, 0]])).toBeCloseTo(-5, 12);
  expect(slopeOf([[0, 0, 1], [0, 0, 2]])).toBeNull();
});

describe('a measurement', () => {
  test('says nothing before it has its points', () => {
    expect(valueOf('area', kSquare.slice(0, 2))).toBeNull();
    expect(valueOf('distance', kSquare.slice(0, 1))).toBeNull();
    expect(valueOf('section', kSquare.slice(0, 2))).toBeCloseTo(4);
    expect(valueOf('height', [[0, 0, 2], [5, 5, 1.5]])).toBeCloseTo(-0.5);
  });
  test('is read with the digits that the map has', () => {
    expect(formatValue('distance', 12.3456)).toBe('12.35 m');
    expect(formatValue('area', 12.3456)).toBe('12.35 m²');
    expect(formatValue('height', 0.0421)).toBe('+0.042 m');
    expect(formatValue('height', -0.0421)).toBe('-0.042 m');
    expect(formatValue('height', -0.0001)).toBe('0.000 m');
    expect(formatValue('height', 0.0001)).toBe('0.000 m');
    expect(formatValue('slope', 6.04)).toBe('+6.0 %');
  });
});
