// Where the car is at a time of its drive.

import { Quaternion, Vector3 } from 'three';

import { secondsBetween, type TrajectoryPose } from '../api/map_files';
import type { Keyframes, Pose } from '../api/types';
import { countUntil } from './plot_model';

export interface CarPose {
  position: Vector3;
  orientation: Quaternion; // site_from_body
}

/** Poses in order of time. */
export class Poses {
  private readonly times: Float64Array;

  constructor(private readonly poses: readonly TrajectoryPose[]) {
    this.times = Float64Array.from(poses, ({ time }) => time);
  }

  get isEmpty(): boolean {
    return this.poses.length === 0;
  }

  get end(): number {
    return this.times.at(-1) ?? 0;
  }

  /** Between two poses, the way from one to the other; before the first and after the last, those. Null without any. */
  at(seconds: number): CarPose | null {
    if (this.isEmpty) return null;
    const after = Math.min(countUntil(this.times, seconds), this.poses.length - 1);
    const before = Math.max(0, after - 1);
    const [first, second] = [this.poses[before]!, this.poses[after]!];
    const gap = second.time - first.time;
    const share = gap > 0 ? Math.min(1, Math.max(0, (seconds - first.time) / gap)) : 0;
    return {
      position: new Vector3(...first.position).lerp(new Vector3(...second.position), share),
      orientation: new Quaternion(...first.orientation).slerp(new Quaternion(...second.orientation), share),
    };
  }
}

/** Keyframes as a coarse trajectory of the body, since `start`. */
export function posesOfKeyframes({ keyframes }: Pick<Keyframes, 'keyframes'>, start: string): TrajectoryPose[] {
  return keyframes.map(({ time, site_from_body: { position, orientation } }) => ({
    time: secondsBetween(start, time),
    position,
    orientation,
  }));
}

/**
 * The trajectory's poses are the IMU's. Where the body is in the IMU never changes, so that one place where both are
 * known gives the body's whole trajectory.
 */
export function bodyTrajectory(imu: readonly TrajectoryPose[], known: { time: number; siteFromBody: Pose }): TrajectoryPose[] {
  const there = new Poses(imu).at(known.time);
  if (!there) return [];
  const imuFromSite = there.orientation.clone().invert();
  const offset = new Vector3(...known.siteFromBody.position).sub(there.position).applyQuaternion(imuFromSite);
  const turn = imuFromSite.multiply(new Quaternion(...known.siteFromBody.orientation));
  return imu.map(({ time, position, orientation }) => {
    const siteFromImu = new Quaternion(...orientation);
    return {
      time,
      position: offset.clone().applyQuaternion(siteFromImu).add(new Vector3(...position)).toArray(),
      orientation: siteFromImu.multiply(turn).toArray(),
    };
  });
}

const kTogether = 0.15; // [s] in which the cameras of a car take their pictures of one moment

/** Times to step through, [s]: the cameras' keyframes of one moment are one step. */
export function momentsOf({ keyframes }: Pick<Keyframes, 'keyframes'>, start: string): number[] {
  const moments: number[] = [];
  const seen = new Set<string>();
  for (const { time, camera } of keyframes) {
    const seconds = secondsBetween(start, time);
    const last = moments.at(-1);
    if (last === undefined || seen.has(camera) || seconds - last > kTogether) {
      moments.push(seconds);
      seen.clear();
    }
    seen.add(camera);
  }
  return moments;
}

const kSame = 5e-3; // [s] the address keeps hundredths

/** The moment before or after a time; null at the ends. */
export function nextMoment(moments: readonly number[], seconds: number, step: 1 | -1): number | null {
  if (step > 0) return moments.find((moment) => moment > seconds + kSame) ?? null;
  return moments.findLast((moment) => moment < seconds - kSame) ?? null;
}
