import { Quaternion, Vector3 } from 'three';
import { describe, expect, test } from 'vitest';

import type { TrajectoryPose } from '../api/map_files';
import { bodyTrajectory, momentsOf, nextMoment, Poses } from './poses';

const turned = (degrees: number) => new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), (degrees * Math.PI) / 180).toArray();
const pose = (time: number, x: number, degrees = 0): TrajectoryPose => ({ time, position: [x, 0, 0], orientation: turned(degrees) });

describe('Poses', () => {
  const poses = new Poses([pose(0, 0), pose(1, 2, 90), pose(3, 2, 90)]);
  test('between two poses it is on the way', () => {
    const { position, orientation } = poses.at(0.5)!;
    expect(position.x).toBeCloseTo(1);
    expect(orientation.angleTo(new Quaternion(...turned(45)))).toBeCloseTo(0);
  });
  test('before and after it stands', () => {
    expect(poses.at(-1)!.position.x).toBe(0);
    expect(poses.at(99)!.position.x).toBe(2);
  });
  test('no poses, no car', () => expect(new Poses([]).at(1)).toBeNull());
});

test('the body keeps its place in the IMU', () => {
  // The IMU is 1 m ahead of the body's origin and turned by 180 degrees, as it is mounted backwards.
  const imu: TrajectoryPose[] = [
    { time: 0, position: [1, 0, 0], orientation: turned(180) },
    { time: 1, position: [5, 1, 0], orientation: turned(270) }, // the car looks to y
  ];
  const body = bodyTrajectory(imu, { time: 0, siteFromBody: { position: [0, 0, 0], orientation: turned(0) } });
  expect(body[1]!.position[0]).toBeCloseTo(5);
  expect(body[1]!.position[1]).toBeCloseTo(0);
  expect(new Quaternion(...body[1]!.orientation).angleTo(new Quaternion(...turned(90)))).toBeCloseTo(0);
});

describe('moments', () => {
  const keyframe = (seconds: string, camera: string) => ({
    time: `100.${seconds}`,
    camera,
    site_from_body: { position: [0, 0, 0] as [number, number, number], orientation: [0, 0, 0, 1] as [number, number, number, number] },
  });
  const keyframes = [
    keyframe('000000000', 'cam0'), keyframe('020000000', 'cam1'), keyframe('100000000', 'cam0'),
    keyframe('110000000', 'cam1'), keyframe('500000000', 'cam1'),
  ];
  test('cameras of one moment are one step', () => {
    expect(momentsOf({ keyframes }, '100.000000000').map((time) => Number(time.toFixed(3)))).toEqual([0, 0.1, 0.5]);
  });
  test('steps go on from between, and end at the ends', () => {
    const moments = [0, 0.1, 0.5];
    expect(nextMoment(moments, 0.104, 1)).toBe(0.5); // at 0.1, as an address of hundredths has it
    expect(nextMoment(moments, 0.3, -1)).toBe(0.1);
    expect(nextMoment(moments, 0, -1)).toBeNull();
    expect(nextMoment(moments, 0.5, 1)).toBeNull();
  });
});
