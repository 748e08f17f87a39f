// Parking slots by who stood there last. A click chooses one.

import * as THREE from 'three';

import type { Collection, SlotProperties } from '../../api/map_files';
import type { Vector } from '../../api/types';
import { kCasing, kSlotColors } from './colors';
import { fatLines } from './fat_lines';
import { tintedFaces } from './polygons';

const kLift = 0.04; // [m] above the ground, so that both do not flicker
const kCorners = [0, 1, 2, 0, 2, 3]; // of two triangles

/** What a click on a slot finds in `userData.pick`. */
export interface SlotPick {
  kind: 'slot';
  id: string;
}

export const isSlotPick = (pick: unknown): pick is SlotPick => (pick as Partial<SlotPick> | undefined)?.kind === 'slot';

const lifted = (corners: Vector[]) => corners.map(([x, y, z]): Vector => [x, y, z + kLift]);
const edgesOf = (corners: Vector[]) => corners.flatMap((corner, i) => [corner, corners[(i + 1) % corners.length]!]);

export function centerOf(corners: Vector[]): Vector {
  const mean = (axis: 0 | 1 | 2) => corners.reduce((sum, corner) => sum + corner[axis], 0) / Math.max(1, corners.length);
  return [mean(0), mean(1), mean(2)];
}

/** Faces and edges in one object each, and for each slot a face that is not drawn but can be chosen. */
export function makeSlots(slots: Collection<SlotProperties>): THREE.Object3D[] {
  const shown = slots.features.map(({ properties }) => properties).filter(({ corners_m }) => corners_m.length === 4);
  if (shown.length === 0) return [];
  const [faces, faceColors, edges, edgeColors]: [Vector[], THREE.Color[], Vector[], THREE.Color[]] = [[], [], [], []];
  const unseen = new THREE.MeshBasicMaterial({ visible: false, side: THREE.DoubleSide });
  const choices = shown.map(({ id, state, corners_m }) => {
    const corners = lifted(corners_m);
    const color = new THREE.Color(kSlotColors[state]);
    const triangles = kCorners.map((corner) => corners[corner]!);
    const outline = edgesOf(corners);
    faces.push(...triangles);
    faceColors.push(...triangles.map(() => color));
    edges.push(...outline);
    edgeColors.push(...outline.map(() => color));
    const face = new THREE.BufferGeometry().setAttribute('position', new THREE.Float32BufferAttribute(triangles.flat(), 3));
    const choice = new THREE.Mesh(face, unseen);
    choice.userData['pick'] = { kind: 'slot', id } satisfies SlotPick;
    return choice;
  });
  return [
    tintedFaces(faces, faceColors, 0.35),
    fatLines(edges, { width: 4, color: kCasing, opacity: 0.35, order: 3 }),
    fatLines(edges, { width: 2, colors: edgeColors, order: 4 }),
    ...choices,
  ];
}

/** The frame around the slot that is chosen. */
export function makeSlotFrame({ corners_m }: SlotProperties): THREE.Object3D[] {
  const edges = edgesOf(lifted(corners_m));
  return [fatLines(edges, { width: 8, color: kCasing, opacity: 0.85, order: 5 }), fatLines(edges, { width: 4, color: 0xffffff, order: 6 })];
}
