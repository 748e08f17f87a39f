import { expect, test } from 'vitest';

import type { Collection, SlotProperties, SlotState } from '../api/map_files';
import type { Comparison, Vector } from '../api/types';
import { laterFromEarlier } from './alignment';
import { alignmentSentence, changesOf, sentencesOf, slotCounts, slotsThatDiffer, type RegionProperties } from './changes';

const alignment: Comparison['alignment'] = {
  aligned_by: 'drives', translation: [3, 4, 0], yaw_deg: 1.5, horizontal_sigma: 0.02, height_sigma: 0.01, num_links: 0, note: '',
};
const same: Comparison = {
  site: 'lot', from: 1, to: 2, alignment,
  free_space: { unchanged: 500, gained: 0, lost: 0, freed: 0, mapped: 0, blocked: 0, unmapped: 0 },
  heights: { median: 0, rmse: 0.01, percentile_95: 0.02, raised: 0, lowered: 0 },
  slots: { kept: 26, added: [], removed: [], changed: [] },
  drives: { added: [], removed: [] }, trajectories: [], regions: [],
  urls: { geojson: '', png: '', pgw: '' },
};

const slot = (id: string, x: number, states: Record<string, SlotState> = {}) => ({
  properties: { id, states, corners_m: [[x, 0, 0], [x + 2, 0, 0], [x + 2, 4, 0], [x, 4, 0]] as Vector[] } as SlotProperties,
  geometry: { type: 'Polygon' as const, coordinates: [] },
});

test('regions come first, with their outlines; slots where the version that has them puts them', () => {
  const comparison: Comparison = {
    ...same,
    regions: [
      { id: 0, change: 'freed', area: 6.38, center: [5, 5, 0], height_change: 0 },
      { id: 1, change: 'lowered', area: 12.2, center: [9, 9, 0], height_change: -0.083 },
    ],
    slots: { kept: 1, added: ['slot_new'], removed: ['slot_old'], changed: [{ id: 'slot_kept', from: 'free', to: 'occupied' }] },
  };
  const regions: Collection<RegionProperties> = {
    features: [{
      properties: { id: 0, change: 'freed', area_m2: 6.38, height_change_m: 0 },
      geometry: { type: 'MultiPolygon', coordinates: [[[[4, 4, 0], [6, 4, 0], [6, 6, 0], [4, 4, 0]]]] },
    }],
  };
  const changes = changesOf({
    comparison, regions, toSite: (position) => position as Vector,
    slots: { earlier: { features: [slot('slot_old', 10)] }, later: { features: [slot('slot_new', 20), slot('slot_kept', 30)] } },
    laterFromEarlier: laterFromEarlier({ translation: [3, 4, 0], yaw_deg: 0 }),
  });
  expect(changes.map(({ id }) => id)).toEqual(['region 0', 'region 1', 'slot slot_old', 'slot slot_new', 'slot slot_kept']);
  expect(changes[0]).toMatchObject({ title: 'Freed, 6.4 m²', isLoss: false, outline: [[[4, 4, 0], [6, 4, 0], [6, 6, 0], [4, 4, 0]]] });
  expect(changes[0]!.reach).toBeCloseTo(Math.SQRT2, 6);
  expect(changes[1]).toMatchObject({ title: 'Lowered, 12 m²', about: 'the ground lies lower by 8.3 cm', outline: [] });
  expect(changes[2]!.point).toEqual([14, 6, 0]); // moved into the later site
  expect(changes[3]!.point).toEqual([21, 2, 0]);
  expect(changes[4]).toMatchObject({ title: 'Slot is occupied now', about: 'kept was free', isLoss: true });
  expect(changes[4]!.outline[0]).toHaveLength(5);
});

test('sentences say what matters first, and nothing of what is not', () => {
  expect(sentencesOf(same)).toEqual(['Free space is the same.', "The ground's height is the same within 2.0 cm at 19 of 20 spots.", 'All 26 slots are the same.']);
  const sentences = sentencesOf({
    ...same,
    alignment: { ...alignment, note: 'only a part overlaps' },
    free_space: { ...same.free_space, freed: 10.45, blocked: 48.3 },
    heights: { ...same.heights, raised: 3.2 },
    slots: { kept: 2, added: ['a'], removed: [], changed: [{ id: 'b', from: 'free', to: 'occupied' }] },
    drives: { added: ['day2'], removed: ['day0'] },
    trajectories: [{ drive: 'day1', median: 0.01, percentile_95: 0.02, largest: 0.03 }],
  });
  expect(sentences).toEqual([
    'Free space lost: 48 m² blocked.', 'Free space gained: 10 m² freed.', 'The ground changed its height: 3.2 m² raised.',
    'Slots: 1 new, 1 of another state; 2 kept.', 'New drives: day2.', 'Drives no longer in it: day0.',
    'Trajectories moved by 3.0 cm at most (day1).', 'Only a part overlaps.',
  ]);
  expect(alignmentSentence(same)).toContain('moved by 5.00 m and turned by 1.50° by the drives that both have');
});

test('two sessions differ where both saw a slot', () => {
  const slots = { features: [slot('slot_a', 0, { x: 'free', y: 'occupied' }), slot('slot_b', 9, { x: 'free', y: 'unseen' }), slot('slot_c', 9, { x: 'free', y: 'free' }), slot('slot_d', 9, { x: 'free' })] };
  expect(slotsThatDiffer(slots, 'x', 'y').map(({ id, title, isLoss }) => [id, title, isLoss])).toEqual([['slot slot_a', 'Slot is occupied in y', true]]);
  expect(slotCounts(slots, 'x', 'y')).toEqual({ same: 1, different: 1, unseen: 2 });
});
