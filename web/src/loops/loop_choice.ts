// The chosen pair of places in the map: a pole at each, and an arc between them.

import * as THREE from 'three';

import type { Vector } from '../api/types';

/** Unlike those of drives. */
export const kColorOfA = 0xe77cff;
export const kColorOfB = 0xb8e600;
export const kColorOfSpot = 0xff3b6b;
export const kOnColors = 0x10151d; // letters on them

const kHeight = 2.2; // [m] of the poles
const kThickness = 0.07;
const kHead = 0.32;

/** Drawn over everything: a deck above does not hide it. */
function material(color: number): THREE.MeshBasicMaterial {
  return new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true });
}

function pole(foot: THREE.Vector3, color: number): THREE.Object3D[] {
  const stick = new THREE.CylinderGeometry(kThickness, kThickness, kHeight, 8).rotateX(Math.PI / 2).translate(foot.x, foot.y, foot.z + kHeight / 2);
  const head = new THREE.SphereGeometry(kHead, 16, 12).translate(foot.x, foot.y, foot.z + kHeight);
  return [new THREE.Mesh(stick, material(color)), new THREE.Mesh(head, material(color))];
}

/** `isClosed`: the mapper believes that both are tied; else the arc is dashed. */
export function drawPair(a: Vector, b: Vector | null, isClosed: boolean): THREE.Object3D[] {
  const from = new THREE.Vector3(...a);
  const drawn = pole(from, kColorOfA);
  if (b) {
    const to = new THREE.Vector3(...b);
    drawn.push(...pole(to, kColorOfB));
    const distance = from.distanceTo(to);
    const top = new THREE.Vector3(0, 0, kHeight);
    const middle = from.clone().lerp(to, 0.5).add(top).add(new THREE.Vector3(0, 0, 0.4 + 0.25 * distance));
    const arc = new THREE.QuadraticBezierCurve3(from.clone().add(top), middle, to.clone().add(top));
    if (isClosed) drawn.push(new THREE.Mesh(new THREE.TubeGeometry(arc, 32, kThickness, 6), material(0xffffff)));
    else {
      const line = new THREE.Line(
        new THREE.BufferGeometry().setFromPoints(arc.getPoints(64)),
        new THREE.LineDashedMaterial({ color: 0xffffff, dashSize: 0.3, gapSize: 0.25, depthTest: false, transparent: true }),
      );
      line.computeLineDistances();
      drawn.push(line);
    }
  }
  for (const object of drawn) object.renderOrder = 20;
  return drawn;
}

/** The spot that both pictures mark. */
export function drawSpot(point: Vector): THREE.Object3D {
  const ring = new THREE.RingGeometry(0.22, 0.34, 32).translate(point[0], point[1], point[2] + 0.02);
  const mesh = new THREE.Mesh(ring, material(kColorOfSpot));
  (mesh.material as THREE.MeshBasicMaterial).side = THREE.DoubleSide;
  mesh.renderOrder = 21;
  return mesh;
}
