import * as THREE from 'three';
import { expect, test } from 'vitest';

import type { SlotCollection, SlotState } from './api';
import { countStates, makeSlotLayer } from './slot_layer';

function slotsInStates(states: SlotState[]): SlotCollection {
  return {
    features: states.map((state, i) => ({
      properties: {
        id: `slot_${i}`,
        type: 'perpendicular',
        state,
        confidence: 1,
        corners_m: [[3 * i, 0, 1], [3 * i + 2.5, 0, 1], [3 * i + 2.5, 5, 1], [3 * i, 5, 1]],
      },
    })),
  };
}

test('each state is one mesh and one outline, north to the back and heights up', () => {
  const layer = makeSlotLayer(slotsInStates(['free', 'free', 'occupied']));

  expect(layer.children.length).toBe(4);
  const box = new THREE.Box3().setFromObject(layer);
  expect(box.min.z).toBeCloseTo(-5);
  expect(box.max.x).toBeCloseTo(8.5);
  expect(box.min.y).toBeGreaterThan(1);
  expect(box.max.y).toBeLessThan(1.1);
});

test('states are counted, and no slots are no layer', () => {
  expect(countStates(slotsInStates(['free', 'occupied', 'free']))).toEqual({ free: 2, occupied: 1, unseen: 0 });
  expect(makeSlotLayer({ features: [] }).children.length).toBe(0);
});
