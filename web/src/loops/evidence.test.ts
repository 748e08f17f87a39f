import { expect, test } from 'vitest';

import type { Report } from '../api/map_files';
import { byDoubt, doubtsOf, evidenceOf, filtered, titleOf } from './evidence';

const measured = { num_inliers: 100, num_camera_pairs: 4, score: 0.05, residual: 0.9, chi_squared: 3, worst_sigma: 0.02, weight: 1 };
const loop = (id: string, change: object) => ({ ...measured, id, earlier: 10, later: 50.5, state: 'accepted', camera_pairs: [], ...change });

const report = {
  map: { ground_area: 1, num_triangles: 1 },
  stages: [],
  warnings: [],
  drives: [
    {
      name: 'day1', length: 1, duration: 1, num_keyframes: 1,
      loops: {
        candidates: [
          loop('3-17', {}),
          loop('5-20', { num_inliers: 26 }),
          loop('6-21', { state: 'too few inliers', num_inliers: 4 }),
          loop('7-22', { state: 'rejected by the pose graph', weight: 0 }),
          loop('8-23', { state: 'forced by the reviewer', camera_pairs: [{ earlier: 'cam0', later: 'cam3', num_inliers: 31 }],
            inliers: { cameras: ['cam0', 'cam3'], times: ['10.000000001', '50.500000000'], points: [[0.1, 0.2, 0.3, 0.4]] }, thumbnails: ['day1/loops/00023-cam3.jpg'] }),
        ],
      },
    },
  ],
  join: {
    pairs: [
      { a: 'day1', b: 'day2', rejected: '', links: [{ ...measured, place_a: 1, place_b: 2, time_a: 7.5, time_b: 8, inliers: { cameras: [0, 1], times: ['7.5', '8.0'], points: [] } }, { ...measured, place_a: 4, place_b: 5, weight: 0, chi_squared: 40 }] },
      { a: 'day1', b: 'day3', rejected: 'too few links agree', links: [{ ...measured, place_a: 1, place_b: 9 }] },
    ],
  },
} as unknown as Report;

test('what a report holds, the accepted that are backed least first and the best rejected next', () => {
  const all = evidenceOf(report);
  expect(all.map(({ id }) => id)).toEqual([
    'day1:5-20', // the fewest inliers
    'day1:3-17', 'day1:8-23', 'day1:1~day2:2',
    'day1:7-22', 'day1:1~day3:9', 'day1:4~day2:5', 'day1:6-21',
  ]);
  expect(all.filter(({ isAccepted }) => isAccepted)).toHaveLength(4);
  expect(all.find(({ id }) => id === 'day1:8-23')).toMatchObject({
    a: { drive: 'day1', index: 8 }, b: { drive: 'day1', index: 23 }, times: { a: 10, b: 50.5 },
    cameras: [{ a: 'cam0', b: 'cam3', inliers: 31 }], thumbnails: { a: null, b: 'day1/loops/00023-cam3.jpg' },
  });
  expect(all.find(({ id }) => id === 'day1:8-23')?.shown).toEqual({
    cameras: { a: 'cam0', b: 'cam3' }, times: { a: '10.000000001', b: '50.500000000' }, points: [{ a: [0.1, 0.2], b: [0.3, 0.4] }],
  });
  expect(all.find(({ id }) => id === 'day1:1~day2:2')).toMatchObject({ times: { a: 7.5, b: 8 }, shown: null });
  expect(all.find(({ id }) => id === 'day1:4~day2:5')).toMatchObject({ times: null, shown: null });
  expect(all.find(({ id }) => id === 'day1:1~day3:9')?.state).toBe('too few links agree');
});

test('what was decided about a link is said in its state', () => {
  const decided = (state: string, weight: number) =>
    evidenceOf({ ...report, drives: [], join: { pairs: [{ a: 'x', b: 'y', rejected: '', links: [{ ...measured, place_a: 1, place_b: 2, weight, state }] }] } } as unknown as Report)[0];
  expect(decided('rejected by the reviewer', 0)).toMatchObject({ isAccepted: false, state: 'rejected by the reviewer' });
  expect(decided('forced by the reviewer', 1)).toMatchObject({ isAccepted: true });
});

test('a contradiction counts as doubt, however many inliers there are', () => {
  const [clear, odd] = [evidenceOf(report)[1]!, { ...evidenceOf(report)[1]!, chiSquared: 30 }];
  expect(byDoubt([clear, odd])[0]).toBe(odd);
  expect(doubtsOf(clear)).toEqual([]);
  expect(doubtsOf(odd)).toEqual(['contradicts the rest of the map']);
  expect(doubtsOf({ ...clear, inliers: 30, cameraPairs: 1, worstSigma: 0.2 })).toHaveLength(3);
});

test('a report without loops and links has none', () => {
  expect(evidenceOf({ ...report, drives: [{ name: 'a', length: 1, duration: 1, num_keyframes: 1 }], join: null })).toEqual([]);
});

test('filters hold together', () => {
  const all = evidenceOf(report);
  const ids = (filter: Parameters<typeof filtered>[1]) => filtered(all, filter, (id) => id === 'day1:3-17').map(({ id }) => id);
  expect(ids({ kind: 'loop', state: 'accepted', decision: 'undecided' })).toEqual(['day1:5-20', 'day1:8-23']);
  expect(ids({ kind: 'all', state: 'all', decision: 'decided' })).toEqual(['day1:3-17']);
  expect(ids({ kind: 'link', state: 'rejected', decision: 'all' })).toEqual(['day1:1~day3:9', 'day1:4~day2:5']);
});

test('titles name both places', () => {
  expect(titleOf(evidenceOf(report)[0]!)).toBe('day1: 5 ↔ 20');
  expect(titleOf(evidenceOf(report)[3]!)).toBe('day1 1 ↔ day2 2');
});
