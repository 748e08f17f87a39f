// Outlines of changes in a scene: all of them thin, the chosen one thick and filled.

import * as THREE from 'three';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';

import type { Vector } from '../api/types';
import type { Change } from './changes';

const kLoss = 0xd1495b;
const kGain = 0x2a9d6f;
const kChosen = 0xffd400;
const kLift = 0.06; // [m] above the ground

const kWidths = { thin: 1.6, thick: 4 }; // [px]

/** Pairs of points: the edges of rings. */
function edgesOf(rings: readonly Vector[][]): number[] {
  const edges: number[] = [];
  for (const ring of rings)
    for (let i = 1; i < ring.length; ++i) {
      const [from, to] = [ring[i - 1]!, ring[i]!];
      edges.push(from[0], from[1], from[2] + kLift, to[0], to[1], to[2] + kLift);
    }
  return edges;
}

function lines(edges: number[], color: number, width: number, order: number): LineSegments2[] {
  if (edges.length === 0) return [];
  const material = new LineMaterial({ color, linewidth: width, depthTest: false, transparent: true });
  const drawn = new LineSegments2(new LineSegmentsGeometry().setPositions(edges), material);
  drawn.renderOrder = order;
  drawn.frustumCulled = false;
  return [drawn];
}

function fill(change: Change): THREE.Mesh[] {
  const ring = change.outline[0];
  if (!ring || ring.length < 4) return [];
  const shape = new THREE.Shape(ring.map(([x, y]) => new THREE.Vector2(x, y)));
  for (const hole of change.outline.slice(1)) shape.holes.push(new THREE.Path(hole.map(([x, y]) => new THREE.Vector2(x, y))));
  const height = ring.reduce((sum, point) => sum + point[2], 0) / ring.length;
  const geometry = new THREE.ShapeGeometry(shape).translate(0, 0, height + kLift);
  const material = new THREE.MeshBasicMaterial({ color: kChosen, transparent: true, opacity: 0.22, depthTest: false, depthWrite: false, side: THREE.DoubleSide });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.renderOrder = 18;
  return [mesh];
}

/** In the later site; for a scene of the earlier one, its layer is moved. */
export function drawChanges(changes: readonly Change[], chosen: Change | null): THREE.Object3D[] {
  const edges = (isLoss: boolean) => changes.filter((change) => change !== chosen && change.isLoss === isLoss).flatMap(({ outline }) => edgesOf(outline));
  return [
    ...lines(edges(true), kLoss, kWidths.thin, 19),
    ...lines(edges(false), kGain, kWidths.thin, 19),
    ...(chosen ? [...fill(chosen), ...lines(edgesOf(chosen.outline), kChosen, kWidths.thick, 20)] : []),
  ];
}
