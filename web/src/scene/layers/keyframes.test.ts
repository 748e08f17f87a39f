import { expect, test } from 'vitest';

import type { Keyframes } from '../../api/types';
import { frustaOf, makeKeyframes } from './keyframes';

const still = { position: [0, 0, 0], orientation: [0, 0, 0, 1] };
const shot = {
  cameras: [{ name: 'cam0', width: 640, height: 400, body_from_camera: still }],
  keyframes: [
    { time: '1.000000000', camera: 'cam0', site_from_body: { position: [5, 6, 7], orientation: [0, 0, 0, 1] } },
    { time: '2.000000000', camera: 'gone', site_from_body: still },
  ],
} as unknown as Keyframes;

test('a camera looks along its z axis from where it was', () => {
  const ends = frustaOf(shot);
  expect(ends).toHaveLength(16); // eight edges; a camera that is not listed has none
  expect(ends[0]).toEqual([5, 6, 7]);
  const corner = ends[1]!;
  expect(corner[2]).toBeGreaterThan(7);
  expect(Math.abs(corner[0] - 5)).toBeGreaterThan(Math.abs(corner[1] - 6)); // as wide as the picture is
});

test('all keyframes are one object', () => {
  expect(makeKeyframes([{ keyframes: shot, color: 1 }, { keyframes: shot, color: 2 }])).toHaveLength(1);
  expect(makeKeyframes([])).toHaveLength(0);
});
