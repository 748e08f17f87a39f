// Where each picture of a drive was taken from, as a small pyramid that opens to where the camera looks.

import * as THREE from 'three';

import type { Keyframes, Pose, Vector } from '../../api/types';
import { unpickable } from './fat_lines';

const kLength = 0.45; // [m] of a pyramid
const kHalfWidth = 0.75; // of its length: wide lenses are drawn alike

function matrixOf({ position, orientation }: Pose): THREE.Matrix4 {
  const [x, y, z] = position as Vector;
  const [qx, qy, qz, qw] = orientation as [number, number, number, number];
  return new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), new THREE.Quaternion(qx, qy, qz, qw), new THREE.Vector3(1, 1, 1));
}

/** Ends of the eight edges of each keyframe's pyramid, [m] in site. Cameras that are not listed are left out. */
export function frustaOf({ cameras, keyframes }: Pick<Keyframes, 'cameras' | 'keyframes'>): Vector[] {
  const known = new Map(
    cameras.map(({ name, width, height, body_from_camera }) => {
      const [x, y, z] = [kLength * kHalfWidth, (kLength * kHalfWidth * height) / Math.max(1, width), kLength];
      const corners = [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]].map(([a, b, c]) => new THREE.Vector3(a, b, c));
      return [name, { corners, bodyFromCamera: matrixOf(body_from_camera) }];
    }),
  );
  return keyframes.flatMap(({ camera, site_from_body }) => {
    const found = known.get(camera);
    if (!found) return [];
    const siteFromCamera = matrixOf(site_from_body).multiply(found.bodyFromCamera);
    const tip = new THREE.Vector3().applyMatrix4(siteFromCamera).toArray();
    const corners = found.corners.map((corner) => corner.clone().applyMatrix4(siteFromCamera).toArray());
    return corners.flatMap((corner, i) => [tip, corner, corner, corners[(i + 1) % 4]!]);
  });
}

export function makeKeyframes(drives: { keyframes: Keyframes; color: number }[]): THREE.Object3D[] {
  const [ends, colors]: [number[], number[]] = [[], []];
  for (const { keyframes, color } of drives) {
    const rgb = new THREE.Color(color).toArray();
    for (const end of frustaOf(keyframes)) {
      ends.push(...end);
      colors.push(...rgb);
    }
  }
  if (ends.length === 0) return [];
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(ends, 3));
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(colors, 3));
  const lines = unpickable(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true, transparent: true })));
  lines.renderOrder = 3;
  return [lines];
}
