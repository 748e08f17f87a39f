// Where the earlier version's site lies in the later one's: turned about the vertical, and moved.

import { Matrix4 } from 'three';

import type { Comparison, Vector } from '../api/types';
import type { CameraView } from '../scene/map_scene';

export type Alignment = Pick<Comparison['alignment'], 'translation' | 'yaw_deg'>;

export function laterFromEarlier({ translation, yaw_deg }: Alignment): Matrix4 {
  const [x, y, z] = translation as Vector;
  return new Matrix4().makeRotationZ((yaw_deg * Math.PI) / 180).setPosition(x, y, z);
}

export const earlierFromLater = (alignment: Alignment): Matrix4 => laterFromEarlier(alignment).invert();

export function moved([x, y, z]: Vector, matrix: Matrix4): Vector {
  const e = matrix.elements as unknown as number[];
  return [0, 1, 2].map((row) => e[row]! * x + e[row + 4]! * y + e[row + 8]! * z + e[row + 12]!) as Vector;
}

/** The same camera, in the other version's site. */
export const movedView = ({ position, target }: CameraView, matrix: Matrix4): CameraView => ({
  position: moved(position, matrix),
  target: moved(target, matrix),
});
