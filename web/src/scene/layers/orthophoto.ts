// The ground from above as one picture, laid over the highest deck.

import * as THREE from 'three';

import { unpickable } from './fat_lines';

const kLift = 0.05; // [m] above the ground
const kMaxSteps = 96; // of the net that follows the ground
const kMostPixels = 4096; // a side that is shown: 64 MiB of the graphics card

/** Where a picture lies, [m] in site: its outer edges. */
export interface PictureFrame {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** Six lines of a world file: the size of a pixel and the center of the upper left one, in the site. Turned pictures are refused. */
export function frameOf(worldFile: string, columns: number, rows: number): PictureFrame {
  const numbers = worldFile.trim().split(/\s+/).map(Number);
  const [across, turnA, turnB, down, x, y] = numbers as [number, number, number, number, number, number];
  if (numbers.length !== 6 || !numbers.every(Number.isFinite) || turnA !== 0 || turnB !== 0 || across <= 0 || down >= 0)
    throw new Error('the world file of the orthophoto is not one of a picture with north up');
  return { left: x - across / 2, top: y - down / 2, width: columns * across, height: -rows * down };
}

/** Columns and rows of a PNG file, by its first bytes. */
export function sizeOfPng(bytes: ArrayBuffer): [number, number] {
  const view = new DataView(bytes);
  if (bytes.byteLength < 24 || view.getUint32(0) !== 0x89504e47) throw new Error('the orthophoto is no PNG file');
  return [view.getUint32(16), view.getUint32(20)];
}

/** A net over a frame. Where `heightAt` [m] has no answer it continues what lies around; `otherwise` is for no ground at all. */
export function netOver(
  frame: PictureFrame,
  heightAt: (x: number, y: number) => number | null,
  otherwise: number,
): THREE.BufferGeometry {
  const steps = (length: number) => Math.min(kMaxSteps, Math.max(1, Math.ceil(length)));
  const net = new THREE.PlaneGeometry(frame.width, frame.height, steps(frame.width), steps(frame.height));
  net.translate(frame.left + frame.width / 2, frame.top - frame.height / 2, 0);
  const position = net.getAttribute('position');
  const known = Array.from({ length: position.count }, (_, i) => heightAt(position.getX(i), position.getY(i)));
  const heights = continued(known, steps(frame.width) + 1);
  for (let i = 0; i < position.count; ++i) position.setZ(i, (heights[i] ?? otherwise) + kLift);
  return net;
}

/** Heights of a grid whose gaps take the mean of their neighbors, from their rims inward. */
function continued(heights: (number | null)[], columns: number): (number | null)[] {
  let all = heights;
  while (all.includes(null) && all.some((height) => height !== null)) {
    const before = all;
    all = before.map((height, i) => {
      if (height !== null) return height;
      const [isFirst, isLast] = [i % columns === 0, i % columns === columns - 1];
      const around = [before[i - columns], before[i + columns], isFirst ? null : before[i - 1], isLast ? null : before[i + 1]];
      const known = around.filter((each) => each !== null && each !== undefined);
      return known.length === 0 ? null : known.reduce((sum, each) => sum + each, 0) / known.length;
    });
  }
  return all;
}

export async function makeOrthophoto(
  png: Blob,
  worldFile: string,
  heightAt: (x: number, y: number) => number | null,
  otherwise: number,
): Promise<THREE.Object3D> {
  const [columns, rows] = sizeOfPng(await png.slice(0, 24).arrayBuffer());
  const scale = Math.min(1, kMostPixels / Math.max(columns, rows));
  const picture = await createImageBitmap(png, {
    imageOrientation: 'flipY',
    resizeWidth: Math.max(1, Math.round(scale * columns)),
    resizeHeight: Math.max(1, Math.round(scale * rows)),
    resizeQuality: 'medium',
  });
  const texture = new THREE.Texture(picture);
  texture.flipY = false; // the browser did
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  // Only the ground hides the layers that come after it.
  const material = new THREE.MeshBasicMaterial({ map: texture, transparent: true, alphaTest: 0.5, depthWrite: false });
  const mesh = unpickable(new THREE.Mesh(netOver(frameOf(worldFile, columns, rows), heightAt, otherwise), material));
  mesh.renderOrder = 1;
  return mesh;
}
