// Where the cameras of a rig are on its car, from the files that it is stored as (Kalibr's conventions).

import type { Vector } from '../api/types';
import { parseYaml, type YamlValue } from './rig_yaml';

/** Rows of a rigid transform. */
type Rotation = [Vector, Vector, Vector];
export interface Rigid {
  rotation: Rotation;
  translation: Vector;
}

export interface RigCamera {
  name: string;
  topic: string;
  width: number; // [px]
  height: number;
  lens: string;
  /** body_from_camera; where the rig has no vehicle, imu_from_camera. */
  pose: Rigid;
  /** [radians] from the axis to the left and right edge, and to the upper and lower one. */
  halfWidth: number;
  halfHeight: number;
  mask: string | null;
}

export interface RigShape {
  cameras: RigCamera[];
  imu: Vector; // in the frame of the cameras' poses
  gnss: Vector | null;
  /** Without vehicle.yaml nobody knows where the body is: then the IMU is the origin. */
  hasBody: boolean;
  wheelbase: number | null; // [m]
  track: number | null; // [m]
}

const text = (file: Uint8Array) => new TextDecoder().decode(file);

/** Throws where a file is missing or does not say what a rig must. */
export function rigOf(files: ReadonlyMap<string, Uint8Array>): RigShape {
  const find = (name: string) => [...files].find(([path]) => path === name || path.endsWith(`/${name}`))?.[1];
  const chain = find('camchain-imucam.yaml');
  if (!chain) throw new Error('the rig has no camchain-imucam.yaml');
  const vehicleFile = find('vehicle.yaml');
  const vehicle = vehicleFile ? parseYaml(text(vehicleFile)) : {};
  const imuFromBody = 'T_imu_body' in vehicle ? rigidOf(vehicle['T_imu_body']!, 'T_imu_body') : null;
  const bodyFromImu = imuFromBody ? inverse(imuFromBody) : kIdentity;
  const cameras = Object.entries(parseYaml(text(chain)))
    .filter(([name]) => /^cam\d+$/.test(name))
    .map(([name, value]) => cameraOf(name, value, bodyFromImu));
  if (cameras.length === 0) throw new Error('camchain-imucam.yaml names no camera (cam0, cam1, ...)');
  const gnss = vehicle['p_body_gnss'];
  return {
    cameras,
    imu: bodyFromImu.translation,
    gnss: gnss === undefined ? null : vectorOf(gnss, 'p_body_gnss'),
    hasBody: imuFromBody !== null,
    wheelbase: typeof vehicle['wheelbase'] === 'number' ? vehicle['wheelbase'] : null,
    track: typeof vehicle['track'] === 'number' ? vehicle['track'] : null,
  };
}

function cameraOf(name: string, value: YamlValue, bodyFromImu: Rigid): RigCamera {
  if (value === null || typeof value !== 'object' || Array.isArray(value)) throw new Error(`${name} is no camera`);
  const cameraFromImu = value['T_cam_imu'];
  if (cameraFromImu === undefined) throw new Error(`${name} has no T_cam_imu`);
  const [width, height] = numbers(value['resolution'], 2, `${name}: resolution`);
  const [fx, fy, cx, cy] = numbers(value['intrinsics'], 4, `${name}: intrinsics`);
  const isFisheye = value['distortion_model'] === 'equidistant';
  // A fisheye's pixels count angles from the axis, to first order; a pinhole's, tangents.
  const angle = (pixels: number, focal: number) => (isFisheye ? pixels / focal : Math.atan(pixels / focal));
  return {
    name,
    topic: String(value['rostopic'] ?? ''),
    width: width!,
    height: height!,
    lens: isFisheye ? 'fisheye' : String(value['distortion_model'] ?? 'pinhole'),
    pose: times(bodyFromImu, inverse(rigidOf(cameraFromImu, `${name}: T_cam_imu`))),
    halfWidth: angle(Math.max(cx!, width! - cx!), fx!),
    halfHeight: angle(Math.max(cy!, height! - cy!), fy!),
    mask: typeof value['mask'] === 'string' ? value['mask'] : null,
  };
}

/** "front, 21° down": where a camera looks, for checking that nobody swapped two. Poses are body_from_camera. */
export function lookOf({ rotation }: Rigid): string {
  const [x, y, z] = [rotation[0][2], rotation[1][2], rotation[2][2]];
  const down = Math.round((Math.asin(Math.max(-1, Math.min(1, -z))) * 180) / Math.PI);
  const tilt = down === 0 ? 'level' : down > 0 ? `${down}° down` : `${-down}° up`;
  if (Math.hypot(x, y) < 0.05) return down > 0 ? 'straight down' : 'straight up';
  const eighth = Math.round((Math.atan2(y, x) * 4) / Math.PI);
  const names: Record<number, string> = {
    [-4]: 'back', [-3]: 'back right', [-2]: 'right', [-1]: 'front right', 0: 'front', 1: 'front left', 2: 'left', 3: 'back left', 4: 'back',
  };
  return `${names[eighth]}, ${tilt}`;
}

const kIdentity: Rigid = { rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], translation: [0, 0, 0] };

export function inverse({ rotation: r, translation: t }: Rigid): Rigid {
  const column = (i: 0 | 1 | 2): Vector => [r[0][i], r[1][i], r[2][i]];
  const rotation: Rotation = [column(0), column(1), column(2)];
  return { rotation, translation: rotation.map((row) => -dot(row, t)) as Vector };
}

export function times(a: Rigid, b: Rigid): Rigid {
  const turned = inverse({ rotation: b.rotation, translation: [0, 0, 0] }).rotation; // its rows are b's columns
  return {
    rotation: a.rotation.map((row) => turned.map((column) => dot(row, column))) as Rotation,
    translation: applied(a, b.translation),
  };
}

export function applied({ rotation, translation }: Rigid, point: Vector): Vector {
  return rotation.map((row, i) => dot(row, point) + translation[i]!) as Vector;
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function numbers(value: YamlValue | undefined, count: number, what: string): number[] {
  if (!Array.isArray(value) || value.length < count || !value.every((item) => typeof item === 'number'))
    throw new Error(`${what} must be ${count} numbers`);
  return value as number[];
}

function vectorOf(value: YamlValue, what: string): Vector {
  return numbers(value, 3, what).slice(0, 3) as Vector;
}

function rigidOf(value: YamlValue, what: string): Rigid {
  if (!Array.isArray(value) || value.length < 3) throw new Error(`${what} must be a matrix of four rows`);
  const rows = value.slice(0, 3).map((row) => numbers(row, 4, what));
  return { rotation: rows.map((row) => row.slice(0, 3)) as Rotation, translation: rows.map((row) => row[3]!) as Vector };
}
