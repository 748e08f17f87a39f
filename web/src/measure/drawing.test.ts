import { expect, test } from 'vitest';

import { Drawing } from './drawing.svelte';

test('a line grows, shrinks and ends', () => {
  const drawing = new Drawing();
  drawing.begin('distance');
  drawing.add([0, 0, 0]);
  expect(drawing.value).toBeNull();
  drawing.end();
  expect(drawing.isDone).toBe(false); // one point is no line
  drawing.candidate = [3, 4, 0];
  expect(drawing.value).toBeCloseTo(5);
  expect(drawing.canEnd).toBe(false); // what is only pointed at is not drawn yet
  drawing.add([1, 0, 0]);
  drawing.add([9, 9, 9]);
  drawing.removeLast();
  drawing.end();
  expect(drawing.isDone).toBe(true);
  expect(drawing.value).toBeCloseTo(1);
  drawing.add([5, 5, 5]);
  drawing.removeLast();
  expect(drawing.points).toHaveLength(2);
});

test('heights and slopes end by themselves', () => {
  const drawing = new Drawing();
  drawing.begin('slope');
  drawing.add([0, 0, 0]);
  drawing.add([10, 0, 1]);
  expect(drawing.isDone).toBe(true);
  expect(drawing.value).toBeCloseTo(10);
  drawing.begin('area');
  expect([drawing.points.length, drawing.isDone]).toEqual([0, false]);
});

test('a slope straight up does not end', () => {
  const drawing = new Drawing();
  drawing.begin('slope');
  drawing.add([0, 0, 0]);
  drawing.add([0, 0, 1]);
  expect(drawing.isDone).toBe(false);
});
