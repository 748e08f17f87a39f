import { expect, test } from 'vitest';

import type { Job } from '../api/types';
import { failureOf, queuePlaceOf, stagesOf } from './job_words';

const states = (job: Pick<Job, 'state' | 'stage' | 'drives'>) => stagesOf(job).map(({ state }) => state);

test('stages before the running one are done', () => {
  expect(states({ state: 'running', stage: 'refine', drives: ['a', 'b'] }).slice(0, 4)).toEqual(['done', 'done', 'running', 'ahead']);
  expect(states({ state: 'failed', stage: 'close loops', drives: ['a'] }).slice(0, 3)).toEqual(['done', 'stopped', 'ahead']);
  expect(new Set(states({ state: 'done', stage: null, drives: ['a'] }))).toEqual(new Set(['done']));
  expect(new Set(states({ state: 'queued', stage: null, drives: ['a'] }))).toEqual(new Set(['ahead']));
});

test('one drive has no slots to compare, and a stage of a newer service is shown', () => {
  expect(stagesOf({ state: 'running', stage: 'mesh', drives: ['a'] }).map(({ name }) => name)).not.toContain('slots by drive');
  expect(stagesOf({ state: 'running', stage: 'polish', drives: ['a'] }).at(-1)).toMatchObject({ name: 'polish', state: 'running' });
});

test('the oldest that waits is next', () => {
  const job = (id: string, state: Job['state'], created_at: string) => ({ id, state, created_at, not_before: null }) as Job;
  const jobs = [job('c', 'queued', '2026-03'), job('b', 'queued', '2026-02'), job('a', 'running', '2026-01')];
  expect(jobs.map((one) => queuePlaceOf(one, jobs))).toEqual([2, 1, null]);
});

test('every failure says what to do', () => {
  for (const code of ['invalid_input', 'out_of_memory', 'crashed', 'time_limit', 'disk_full', 'internal', 'cancelled', null] as const)
    expect(failureOf(code).next.length).toBeGreaterThan(20);
});
