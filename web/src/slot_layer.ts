import * as THREE from 'three';

import type { SlotCollection, SlotState } from './api';
import { element } from './dom';

// Told apart without red-green vision too: they differ in lightness.
const kColors: Record<SlotState, number> = { free: 0x43d69b, occupied: 0xe0554f, unseen: 0x9aa4b2 };
const kLift = 0.03; // [m] above the ground, so that both do not flicker

/** glTF's y is up: (x, y, z) of the site is (x, z, -y). */
function position([x, y, z]: [number, number, number]): [number, number, number] {
  return [x, z + kLift, -y];
}

/** A tinted face and an outline for each slot, colored by who stood there last. */
export function makeSlotLayer(slots: SlotCollection): THREE.Group {
  const layer = new THREE.Group();
  layer.name = 'slots';
  for (const state of Object.keys(kColors) as SlotState[]) {
    const faces: number[] = [];
    const edges: number[] = [];
    for (const { properties } of slots.features) {
      if (properties.state !== state) continue;
      const corners = properties.corners_m.map(position);
      if (corners.length !== 4) continue;
      for (const i of [0, 1, 2, 0, 2, 3]) faces.push(...corners[i]!);
      for (let i = 0; i < 4; ++i) edges.push(...corners[i]!, ...corners[(i + 1) % 4]!);
    }
    if (faces.length === 0) continue;
    const geometryOf = (values: number[]) =>
      new THREE.BufferGeometry().setAttribute('position', new THREE.Float32BufferAttribute(values, 3));
    const color = kColors[state];
    const face = new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.35, side: THREE.DoubleSide });
    face.depthWrite = false;
    const mesh = new THREE.Mesh(geometryOf(faces), face);
    mesh.renderOrder = 1;
    const lines = new THREE.LineSegments(geometryOf(edges), new THREE.LineBasicMaterial({ color }));
    lines.renderOrder = 2;
    layer.add(mesh, lines);
  }
  return layer;
}

/** How many slots are in each state. */
export function countStates(slots: SlotCollection): Record<SlotState, number> {
  const counts: Record<SlotState, number> = { free: 0, occupied: 0, unseen: 0 };
  for (const { properties } of slots.features) counts[properties.state] += 1;
  return counts;
}

/** What the colors mean, with numbers; hidden where there are no slots. */
export function renderSlotLegend(place: HTMLElement, counts: Record<SlotState, number>): void {
  const states = (Object.keys(kColors) as SlotState[]).filter((state) => counts[state] > 0);
  place.replaceChildren(
    ...states.map((state) => {
      const entry = element('span', {}, `${counts[state]} ${state}`);
      entry.style.setProperty('--swatch', `#${kColors[state].toString(16).padStart(6, '0')}`);
      return entry;
    }),
  );
  place.hidden = states.length === 0;
}
