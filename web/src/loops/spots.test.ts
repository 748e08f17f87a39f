import { Matrix4 } from 'three';
import { expect, test } from 'vitest';

import { pointAround, viewNear, type View } from './spots';

const view = (time: string): View => ({ camera: 'cam0', time, pixel: [1, 2], distance: 3, view_angle: 1, resolution: 20, url: '' });

test('the picture nearest in time, and none from another visit', () => {
  const views = [view('100.0'), view('104.4'), view('105.1')];
  expect(viewNear(views, 104.9)?.time).toBe('105.1');
  expect(viewNear(views, 50)).toBeNull();
  expect(viewNear([], 104)).toBeNull();
});

test('ahead is where the car looks', () => {
  const [x, y] = pointAround(new Matrix4().makeRotationZ(Math.PI / 2).setPosition(10, 0, 1), 8, 1);
  expect(x).toBeCloseTo(9, 9);
  expect(y).toBeCloseTo(8, 9);
});
