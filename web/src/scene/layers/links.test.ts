import { expect, test } from 'vitest';

import type { Report } from '../../api/map_files';
import { arcOf, linksOf, loopsOf, makeEdges } from './links';
import type { Track } from './track';

const along = (y: number): Track => ({
  start: '100.000000000',
  poses: [0, 10].map((time) => ({ time, position: [time, y, 0], orientation: [0, 0, 0, 1] })),
});
const trackOf = (name: string) => (name === 'a' ? along(0) : name === 'b' ? along(1) : null);

test('loops lie where the drive was at both times', () => {
  const report = {
    drives: [{ name: 'a', loops: { candidates: [
      { id: '1-4', earlier: 101, later: 104.5, state: 'accepted' },
      { id: '2-4', earlier: 102, later: 104, state: 'rejected by the pose graph' },
      { id: '3-4', earlier: 103, later: 104, state: 'forced by the reviewer' },
      { id: '3-9', earlier: 103, later: 999, state: 'accepted' },
    ] } }],
  } as unknown as Report;
  const { edges, count } = loopsOf(report, trackOf);
  expect(count).toBe(4);
  expect(edges.map(({ state }) => state)).toEqual(['accepted', 'rejected', 'open']);
  expect(edges[0]!.from[0]).toBeCloseTo(1);
  expect(edges[0]!.to[0]).toBeCloseTo(4.5);
});

test('links between drives need times; those without are counted', () => {
  const report = {
    drives: [],
    join: { pairs: [{ a: 'a', b: 'b', rejected: '', links: [
      { place_a: 0, place_b: 1, weight: 1, time_a: 102, time_b: 103 },
      { place_a: 0, place_b: 1, weight: 0.1, time_a: 102, time_b: 103 },
      { place_a: 0, place_b: 1, weight: 1 },
      { place_a: 0, place_b: 1, weight: 0, time_a: 102, time_b: 103, state: 'rejected by the reviewer' },
      { place_a: 0, place_b: 1, weight: 1, time_a: 102, time_b: 103, state: 'forced by the reviewer' },
    ] }] },
  } as unknown as Report;
  const { edges, count } = linksOf(report, trackOf);
  expect(count).toBe(5);
  expect(edges.map(({ state }) => state)).toEqual(['accepted', 'rejected', 'rejected', 'open']);
  expect(edges[0]).toMatchObject({ from: [2, 0, 0], to: [3, 1, 0] });
  expect(linksOf({ drives: [] } as unknown as Report, trackOf)).toEqual({ edges: [], count: 0 });
});

test('an arc rises even over a pair at one spot', () => {
  const arc = arcOf({ from: [1, 2, 3], to: [1, 2, 3], state: 'accepted' });
  expect(arc[0]).toEqual([1, 2, 3]);
  expect(Math.max(...arc.map(([, , z]) => z))).toBeGreaterThan(3.5);
  expect(makeEdges([])).toHaveLength(0);
  expect(makeEdges([{ from: [0, 0, 0], to: [1, 0, 0], state: 'rejected' }])).toHaveLength(2);
});
