// The places of a drive, by which loops and links are named: where they lie, when the car was there, and which cameras see the same.

import { Matrix4, Quaternion, Vector3 } from 'three';

import { fetchJson } from '../api/client';
import { fileUrl, parseTum, type TrajectoryPose } from '../api/map_files';
import type { Keyframes, MapVersion, Pose, Vector } from '../api/types';

export interface Place {
  index: number;
  time: number; // [s] on the drive's clock
  siteFromBody: Matrix4;
}

export interface PlacesOfDrive {
  drive: string;
  places: Place[];
  cameras: Keyframes['cameras'];
  /** The car's pose at a time of the drive's clock. */
  poseAt: (time: number) => Matrix4;
  /** Whether as many were counted as the report says. Where not, their numbers are not to be trusted. */
  isSure: boolean;
}

const kSpacing = 2; // [m] between places, unless the version's options say otherwise
const kTurn = (25 * Math.PI) / 180; // one that makes a place too

const matrixOf = ({ position, orientation }: { position: readonly number[]; orientation: readonly number[] }): Matrix4 =>
  new Matrix4().compose(new Vector3().fromArray(position), new Quaternion().fromArray(orientation), new Vector3(1, 1, 1));

/** A pose between two of a trajectory; the first or the last beyond its ends. */
export function poseBetween(poses: readonly TrajectoryPose[], time: number): Matrix4 {
  let [low, high] = [0, poses.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (poses[middle]!.time <= time) low = middle;
    else high = middle;
  }
  const [before, after] = [poses[low]!, poses[high]!];
  const share = after.time > before.time ? Math.min(1, Math.max(0, (time - before.time) / (after.time - before.time))) : 0;
  const position = new Vector3().fromArray(before.position).lerp(new Vector3().fromArray(after.position), share);
  const orientation = new Quaternion().fromArray(before.orientation).slerp(new Quaternion().fromArray(after.orientation), share);
  return new Matrix4().compose(position, orientation, new Vector3(1, 1, 1));
}

/** Times at which the mapper puts its places: every `spacing` meters that the body moved, and at turns. */
export function placeTimes(odometry: readonly TrajectoryPose[], imuFromBody: Matrix4, spacing = kSpacing): number[] {
  const times: number[] = [];
  let way = 0;
  let wayOfLast = 0;
  let headingOfLast = 0;
  let last: Vector3 | null = null;
  for (const pose of odometry) {
    const body = matrixOf(pose).multiply(imuFromBody);
    const position = new Vector3().setFromMatrixPosition(body);
    if (last) way += position.distanceTo(last);
    last = position;
    const heading = Math.atan2(body.elements[1]!, body.elements[0]!); // of the body's forward axis
    const turn = Math.abs(Math.atan2(Math.sin(heading - headingOfLast), Math.cos(heading - headingOfLast)));
    if (times.length > 0 && way - wayOfLast < spacing && turn < kTurn) continue;
    times.push(pose.time);
    wayOfLast = way;
    headingOfLast = heading;
  }
  return times;
}

/** Where the IMU lies in the body: both are known at keyframes. */
export function imuFromBodyOf(trajectory: readonly TrajectoryPose[], origin: number, keyframes: Keyframes['keyframes']): Matrix4 {
  const keyframe = keyframes[0];
  if (!keyframe || trajectory.length === 0) return new Matrix4();
  return poseBetween(trajectory, Number(keyframe.time) - origin).invert().multiply(matrixOf(keyframe.site_from_body));
}

async function fetchTum(map: MapVersion, file: string): Promise<{ origin: number; poses: TrajectoryPose[] }> {
  const response = await fetch(fileUrl(map, file));
  if (!response.ok) throw new Error(`the version's ${file} cannot be read (${response.status})`);
  const text = await response.text();
  const first = text.split('\n').find((line) => line !== '' && !line.startsWith('#'));
  if (first === undefined) throw new Error(`the version's ${file} is empty`);
  return { origin: Number(first.split(' ')[0]), poses: parseTum(text) };
}

export async function fetchPlaces(map: MapVersion, drive: string, numPlaces: number | null, spacing: number | null): Promise<PlacesOfDrive> {
  const [odometry, trajectory, keyframes] = await Promise.all([
    fetchTum(map, `${drive}/odometry.tum`),
    fetchTum(map, `${drive}/trajectory.tum`),
    fetchJson(fileUrl(map, `${drive}/keyframes.json`)) as Promise<Keyframes>,
  ]);
  const imuFromBody = imuFromBodyOf(trajectory.poses, trajectory.origin, keyframes.keyframes);
  const poseAt = (time: number) => poseBetween(trajectory.poses, time - trajectory.origin).multiply(imuFromBody);
  const places = placeTimes(odometry.poses, imuFromBody, spacing ?? kSpacing).map((seconds, index) => {
    const time = odometry.origin + seconds;
    return { index, time, siteFromBody: poseAt(time) };
  });
  return { drive, places, cameras: keyframes.cameras, poseAt, isSure: numPlaces === null || places.length === numPlaces };
}

export const positionOf = (siteFromBody: Matrix4): Vector => new Vector3().setFromMatrixPosition(siteFromBody).toArray();

/** Where a camera looks, in the site. */
function directionOf(siteFromBody: Matrix4, bodyFromCamera: Pose): Vector3 {
  return new Vector3(0, 0, 1).transformDirection(matrixOf(bodyFromCamera)).transformDirection(siteFromBody);
}

interface Seen {
  siteFromBody: Matrix4;
  cameras: Keyframes['cameras'];
}

/** The cameras at two places that look in most nearly the same direction; null where one has none. */
export function alikeCameras(a: Seen, b: Seen): { a: string; b: string } | null {
  let best: { a: string; b: string } | null = null;
  let closest = -2;
  for (const one of a.cameras)
    for (const other of b.cameras) {
      const likeness = directionOf(a.siteFromBody, one.body_from_camera).dot(directionOf(b.siteFromBody, other.body_from_camera));
      if (likeness <= closest) continue;
      closest = likeness;
      best = { a: one.name, b: other.name };
    }
  return best;
}

/** The place of a drive nearest to a point; not one so close to `besides` along the drive that it is the same visit. */
export function nearestPlace(places: readonly Place[], point: Vector, besides: number | null = null): Place | null {
  const target = new Vector3().fromArray(point);
  let best: Place | null = null;
  let least = Infinity;
  for (const place of places) {
    if (besides !== null && Math.abs(place.index - besides) < kApart) continue;
    const distance = new Vector3().setFromMatrixPosition(place.siteFromBody).distanceToSquared(target);
    if (distance >= least) continue;
    least = distance;
    best = place;
  }
  return best;
}

const kApart = 5; // places, some ten meters
