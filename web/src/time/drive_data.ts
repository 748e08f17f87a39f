// What the page shows of a drive over time, asked for once. A drive of an old map has less of it, and says so.

import { request } from '../api/client';
import { fileUrl, hasFile, parseTum, secondsBetween, type Report, type TrajectoryPose } from '../api/map_files';
import type { Drive, Keyframes, MapVersion, Plots } from '../api/types';
import type { MapDrive } from '../map/workspace.svelte';
import { bodyTrajectory, momentsOf, Poses, posesOfKeyframes } from './poses';

export interface DriveData {
  id: string;
  name: string;
  /** On the drive's clock: times of the page count from here. Null where nothing says it. */
  start: string | null;
  end: number; // [s]
  plots: Plots | null;
  /** Of keyframes, [s]. */
  moments: number[];
  poses: Poses;
  /** Names of the cameras, and where each is in the car, where that is known. */
  cameras: { name: string; bodyFromCamera: Keyframes['cameras'][number]['body_from_camera'] | null; aspect: number }[];
  isLogStored: boolean;
  /** What is not there, in the service's words. */
  complaints: string[];
}

const kPlotPoints = 2000; // of a series, for the whole drive
const kRangePoints = 3 * kPlotPoints; // of a stretch that is three times as long as what is shown of it
const kKeyframePoints = 10_000;

const fetchPlots = (map: MapVersion, drive: string) =>
  request('get', '/api/v1/drives/{drive}/plots', { path: { drive }, query: { version: String(map.version), points: kPlotPoints } });

/** The plots between two stamps, as fine as they were measured where that is not too much. */
export const fetchPlotRange = (map: MapVersion, drive: string, from: string, to: string) =>
  request('get', '/api/v1/drives/{drive}/plots', { path: { drive }, query: { version: String(map.version), points: kRangePoints, from, to } });

const fetchKeyframes = (map: MapVersion, drive: string) =>
  request('get', '/api/v1/drives/{drive}/keyframes', {
    path: { drive },
    query: { version: String(map.version), points: kKeyframePoints },
  });

const fetchDrive = (drive: string): Promise<Drive> => request('get', '/api/v1/drives/{drive}', { path: { drive } });

export async function fetchDriveData(map: MapVersion, report: Report, { id, name }: MapDrive): Promise<DriveData> {
  const complaints: string[] = [];
  const orNothing = async <Value>(asked: Promise<Value>): Promise<Value | null> => {
    try {
      return await asked;
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      if (!complaints.includes(reason)) complaints.push(reason);
      return null;
    }
  };
  const [plots, keyframes, drive, trajectory] = await Promise.all([
    orNothing(fetchPlots(map, id)),
    orNothing(fetchKeyframes(map, id)),
    orNothing(fetchDrive(id)),
    orNothing(fetchTrajectoryOf(map, name)),
  ]);
  const start = plots?.start ?? trajectory?.first ?? keyframes?.keyframes[0]?.time ?? null;
  const poses = new Poses(start === null ? [] : posesOf(trajectory, keyframes, start));
  const reported = report.drives.find((other) => other.name === name);
  return {
    id,
    name,
    start,
    end: plots?.end ?? (poses.isEmpty ? (reported?.duration ?? 0) : poses.end),
    plots,
    moments: keyframes && start !== null ? momentsOf(keyframes, start) : [],
    poses,
    cameras: keyframes
      ? keyframes.cameras.map(({ name: camera, width, height, body_from_camera }) => ({
          name: camera,
          bodyFromCamera: body_from_camera,
          aspect: width / height,
        }))
      : camerasOf(drive),
    isLogStored: drive?.log !== 'deleted',
    complaints,
  };
}

const kUsualAspect = 1.6;
const kOtherRoles: readonly string[] = ['imu', 'wheels', 'gnss'];

/** The drive's streams name its cameras even where no keyframes were kept. */
function camerasOf(drive: Drive | null): DriveData['cameras'] {
  const roles = (drive?.streams ?? []).map(({ role }) => role).filter((role) => !kOtherRoles.includes(role));
  return roles.map((name) => ({ name, bodyFromCamera: null, aspect: kUsualAspect }));
}

interface Trajectory {
  first: string; // stamp
  poses: TrajectoryPose[]; // since the first, site_from_imu
}

async function fetchTrajectoryOf(map: MapVersion, name: string): Promise<Trajectory | null> {
  const file = `${name}/trajectory.tum`;
  if (!hasFile(map, file)) return null;
  const response = await fetch(fileUrl(map, file));
  if (!response.ok) throw new Error(`the drive's trajectory could not be loaded: the service answered ${response.status}`);
  const text = await response.text();
  const [first, poses] = [/^-?\d+(\.\d+)?/m.exec(text)?.[0], parseTum(text)];
  return first === undefined || poses.length === 0 ? null : { first, poses };
}

function posesOf(trajectory: Trajectory | null, keyframes: Keyframes | null, start: string): TrajectoryPose[] {
  if (!trajectory) return keyframes ? posesOfKeyframes(keyframes, start) : [];
  const shift = secondsBetween(start, trajectory.first);
  const imu = shift === 0 ? trajectory.poses : trajectory.poses.map((pose) => ({ ...pose, time: pose.time + shift }));
  const known = keyframes?.keyframes[keyframes.keyframes.length >> 1];
  return known ? bodyTrajectory(imu, { time: secondsBetween(start, known.time), siteFromBody: known.site_from_body }) : imu;
}
