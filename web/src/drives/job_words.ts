// Jobs in words: what a stage does, why a job failed, and what to do about it.

import type { Job } from '../api/types';

/** Stages in their order, as server/pipeline/plan_stages.cpp has them, and what each does. */
const kStages: readonly { name: string; about: string }[] = [
  { name: 'track', about: 'Follows the car through the images, with IMU, wheels and GNSS' },
  { name: 'close loops', about: 'Finds places that the drive passed twice' },
  { name: 'refine', about: 'Adjusts all poses and the calibration together' },
  { name: 'join drives', about: 'Brings the drives of the site into one frame' },
  { name: 'observe ground', about: 'Measures where the ground is, and what stands on it' },
  { name: 'fuse surface', about: 'Makes one surface of all that was measured' },
  { name: 'mesh', about: 'Builds the mesh' },
  { name: 'texture', about: 'Colors the mesh with the images' },
  { name: 'slots by drive', about: 'Says of each slot in which drive it was free' },
  { name: 'find markings', about: 'Finds lines, slots and kerbs' },
  { name: 'write', about: 'Writes the files of the map' },
];

export interface StageState {
  name: string;
  about: string;
  state: 'done' | 'running' | 'stopped' | 'ahead';
}

/** The stages of a job, each with how far it is. A stage that this page does not know comes in as it is. */
export function stagesOf({ state, stage, drives }: Pick<Job, 'state' | 'stage' | 'drives'>): StageState[] {
  const several = drives.length > 1;
  const known = kStages.filter(({ name }) => several || name !== 'slots by drive');
  const plan = stage !== null && !known.some(({ name }) => name === stage) ? [...known, { name: stage, about: '' }] : known;
  const at = state === 'done' ? plan.length : plan.findIndex(({ name }) => name === stage);
  return plan.map(({ name, about }, i) => ({
    name,
    about,
    state: i < at ? 'done' : i > at || at < 0 ? 'ahead' : state === 'running' ? 'running' : 'stopped',
  }));
}

/** Where a queued job stands: 1 is next. The oldest goes first; null for jobs that do not wait. */
export function queuePlaceOf(job: Pick<Job, 'id' | 'state'>, jobs: readonly Job[]): number | null {
  if (job.state !== 'queued') return null;
  const waiting = jobs
    .filter(({ state }) => state === 'queued')
    .sort((a, b) => (a.not_before ?? a.created_at).localeCompare(b.not_before ?? b.created_at));
  const at = waiting.findIndex(({ id }) => id === job.id);
  return at < 0 ? null : at + 1;
}

/** Why a job ended without a map, and what can be done, for people who did not write the program. */
export function failureOf(code: Job['error_code']): { title: string; next: string } {
  switch (code) {
    case 'invalid_input':
      return {
        title: 'The drives cannot be mapped as they are',
        next: 'Trying again changes nothing. Look at what the inspection of the drive found, choose another rig, or record the drive anew.',
      };
    case 'out_of_memory':
      return {
        title: 'The memory was not enough',
        next: 'Build the map from fewer or shorter drives, or have whoever runs the service give jobs more memory; then try again.',
      };
    case 'crashed':
      return {
        title: 'The program crashed',
        next: 'That is a fault of Parkade, not of the drive. Try again once; if it comes back, report it with the log below.',
      };
    case 'time_limit':
      return {
        title: 'It took longer than a job may',
        next: 'Try again while less is going on, build from fewer drives, or have whoever runs the service raise the limit.',
      };
    case 'disk_full':
      return {
        title: 'The disk of the service is full',
        next: 'Delete drives that nobody needs, or have whoever runs the service make room; then try again.',
      };
    case 'cancelled':
      return { title: 'Somebody cancelled this job', next: 'Nothing is lost. Try again whenever the map is wanted.' };
    default:
      return {
        title: 'Something went wrong in the service',
        next: 'Try again; if it comes back, send the log below to whoever runs the service.',
      };
  }
}

/** "track" as a heading has it. */
export const capital = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);
