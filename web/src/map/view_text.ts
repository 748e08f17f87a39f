// The camera in an address: six numbers in centimeters.

import type { CameraView } from '../scene/map_scene';
import type { Vector } from '../api/types';

export const textOfView = ({ position, target }: CameraView) => [...position, ...target].map((value) => value.toFixed(2)).join(',');

/** Null where the text is no view. */
export function viewOfText(text: string | null): CameraView | null {
  const numbers = (text ?? '').split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
  if (numbers.length !== 6 || !numbers.every(Number.isFinite)) return null;
  const view = { position: numbers.slice(0, 3) as Vector, target: numbers.slice(3) as Vector };
  return Math.hypot(...view.position.map((value, axis) => value - view.target[axis]!)) > 0.01 ? view : null;
}
