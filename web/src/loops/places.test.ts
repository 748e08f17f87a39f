import { Matrix4, Vector3 } from 'three';
import { expect, test } from 'vitest';

import type { TrajectoryPose } from '../api/map_files';
import type { Vector } from '../api/types';
import { alikeCameras, imuFromBodyOf, nearestPlace, placeTimes, poseBetween, positionOf, type Place } from './places';

const kTurned = Math.SQRT1_2; // of a quaternion: 90 degrees
const pose = (time: number, position: Vector, yaw = 0): TrajectoryPose => ({ time, position, orientation: [0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)] });
const straight = Array.from({ length: 101 }, (_, i) => pose(0.1 * i, [0.1 * i, 0, 0]));

test('places lie two meters apart', () => {
  const times = placeTimes(straight, new Matrix4());
  expect(times.map((time) => Math.round(10 * time))).toEqual([0, 20, 40, 60, 80, 100]);
  expect(placeTimes(straight, new Matrix4(), 5)).toHaveLength(3);
});

test('a turn on the spot makes places too', () => {
  const turning = Array.from({ length: 46 }, (_, i) => pose(i, [0, 0, 0], (2 * i * Math.PI) / 180));
  expect(placeTimes(turning, new Matrix4())).toEqual([0, 13, 26, 39]);
});

test('the way is the body\'s, not that of an IMU that swings around it', () => {
  const turning = Array.from({ length: 20 }, (_, i) => pose(i, [5 * Math.cos(i / 50), 5 * Math.sin(i / 50), 0], i / 50));
  expect(placeTimes(turning, new Matrix4().makeTranslation(-5, 0, 0))).toEqual([0]); // it stands at the center, and turns by 22 degrees
});

test('poses between two, and beyond the ends', () => {
  expect(positionOf(poseBetween(straight, 3.14))[0]).toBeCloseTo(3.14, 9);
  expect(positionOf(poseBetween(straight, -1))).toEqual([0, 0, 0]);
  expect(positionOf(poseBetween(straight, 99))[0]).toBeCloseTo(10, 9);
});

test('the IMU\'s place in the body comes of a keyframe', () => {
  const trajectory = [pose(0, [1, 2, 0.5]), pose(1, [3, 2, 0.5])];
  const keyframe = { time: '100.500000000', camera: 'cam0', site_from_body: { position: [1.4, 2, 0] as Vector, orientation: [0, 0, 0, 1] as [number, number, number, number] } };
  positionOf(imuFromBodyOf(trajectory, 100, [keyframe])).forEach((value, axis) => expect(value).toBeCloseTo([-0.6, 0, -0.5][axis]!, 9));
  expect(imuFromBodyOf(trajectory, 100, []).equals(new Matrix4())).toBe(true);
});

test('cameras that look the same way, though the car came from the other side', () => {
  const camera = (name: string, orientation: [number, number, number, number]) => ({ name, width: 640, height: 400, body_from_camera: { position: [0, 0, 0] as Vector, orientation } });
  const cameras = [camera('front', [0, kTurned, 0, kTurned]), camera('rear', [0, -kTurned, 0, kTurned])];
  const there = { siteFromBody: new Matrix4(), cameras };
  const back = { siteFromBody: new Matrix4().makeRotationZ(Math.PI), cameras };
  expect(alikeCameras(there, there)).toEqual({ a: 'front', b: 'front' });
  expect(alikeCameras(there, back)).toEqual({ a: 'front', b: 'rear' });
  expect(alikeCameras(there, { ...back, cameras: [] })).toBeNull();
});

test('the second place of a pair is another visit', () => {
  const places: Place[] = [0, 2, 4, 6, 8, 10, 4, 2, 0].map((x, index) => ({ index, time: index, siteFromBody: new Matrix4().setPosition(new Vector3(x, 0, 0)) }));
  expect(nearestPlace(places, [2.2, 0, 0])?.index).toBe(1);
  expect(nearestPlace(places, [2.2, 0, 0], 1)?.index).toBe(7);
  expect(nearestPlace(places.slice(0, 3), [2, 0, 0], 1)).toBeNull();
});
