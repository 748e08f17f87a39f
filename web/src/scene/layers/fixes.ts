// GNSS fixes where they lie in the site: a disc for one that placed its drive, a cross for one that did not.

import * as THREE from 'three';

import type { Schemas } from '../../api/client';
import type { Vector } from '../../api/types';
import { kAccepted, kOpen, kRejected, kSpeedBump, kUnknown } from './colors';
import { unpickable } from './fat_lines';

type FileFix = Schemas['GnssFixes']['fixes'][number];
export type FixState = FileFix['state'];

export interface Fix extends Omit<FileFix, 'position'> {
  drive: string;
  position: Vector;
}

/** In the order of a legend. */
export const kFixStates: Record<FixState, { color: number; label: string; about: string }> = {
  used: { color: kAccepted, label: 'used', about: 'it helped to place the drive on Earth' },
  outlier: { color: kRejected, label: 'contradicts the others', about: 'it lies too far from where all others put the drive' },
  vague: { color: kSpeedBump, label: 'too vague', about: 'the receiver declared a larger sigma than is taken' },
  unaligned: { color: kOpen, label: 'of a drive it did not place', about: 'too few fixes of this drive agree, or it is too short' },
  outside: { color: kUnknown, label: 'without a pose', about: 'the trajectory does not reach that time' },
};

export const fixesOf = (drive: string, { fixes }: Schemas['GnssFixes']): Fix[] =>
  fixes.map((fix) => ({ ...fix, drive, position: fix.position as Vector }));

const kSize = 9; // [px] of a point
const kPicture = 32; // [px] of what it is drawn with

/** Opaque where `isIn` says so, of coordinates from -1 to 1. */
function stamp(isIn: (x: number, y: number) => boolean): THREE.DataTexture {
  const at = (i: number) => (2 * (i + 0.5)) / kPicture - 1;
  const texels = new Uint8Array(4 * kPicture * kPicture).fill(255);
  for (let row = 0; row < kPicture; ++row)
    for (let column = 0; column < kPicture; ++column) texels[4 * (row * kPicture + column) + 3] = isIn(at(column), at(row)) ? 255 : 0;
  const texture = new THREE.DataTexture(texels, kPicture, kPicture);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

const isInDisc = (x: number, y: number) => Math.hypot(x, y) < 0.8;
const isInCross = (x: number, y: number) => Math.min(Math.abs(x - y), Math.abs(x + y)) < 0.4;

/** Drawn over everything: a receiver's heights are off by meters, and the ground would hide half of them. */
function points(fixes: readonly Fix[], isIn: (x: number, y: number) => boolean): THREE.Points {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(fixes.flatMap(({ position }) => position), 3));
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(fixes.flatMap(({ state }) => new THREE.Color(kFixStates[state].color).toArray()), 3));
  const drawn = unpickable(
    new THREE.Points(
      geometry,
      new THREE.PointsMaterial({ size: kSize, sizeAttenuation: false, vertexColors: true, map: stamp(isIn), alphaTest: 0.5, transparent: true, depthTest: false }),
    ),
  );
  drawn.renderOrder = 6;
  drawn.userData['fixes'] = fixes;
  return drawn;
}

export function makeFixes(fixes: readonly Fix[]): THREE.Object3D[] {
  const [used, others] = [fixes.filter(({ state }) => state === 'used'), fixes.filter(({ state }) => state !== 'used')];
  return [...(others.length > 0 ? [points(others, isInCross)] : []), ...(used.length > 0 ? [points(used, isInDisc)] : [])];
}

/** Those that an object of makeFixes shows. */
export const fixesShownBy = (object: THREE.Object3D): readonly Fix[] => (object.userData['fixes'] as readonly Fix[] | undefined) ?? [];

/** The fix whose point lies nearest to a pixel, no farther than `reach` [px]. */
export function nearestFix(
  fixes: Iterable<Fix>, [x, y]: [number, number], reach: number, project: (point: Vector) => [number, number] | null,
): Fix | null {
  let [best, least]: [Fix | null, number] = [null, reach];
  for (const fix of fixes) {
    const at = project(fix.position);
    const distance = at ? Math.hypot(at[0] - x, at[1] - y) : Infinity;
    if (distance > least) continue;
    [best, least] = [fix, distance];
  }
  return best;
}
