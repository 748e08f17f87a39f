// Lines of a width in pixels: WebGL's own are one pixel thin.

import * as THREE from 'three';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';

import type { Vector } from '../../api/types';

/** Objects of layers that no click chooses are not looked at by the pointer. */
export function unpickable<Kind extends THREE.Object3D>(object: Kind): Kind {
  object.raycast = () => undefined;
  return object;
}

export interface LineLook {
  width: number; // [px]
  color?: number;
  /** Two for each segment, where they differ. */
  colors?: THREE.Color[];
  opacity?: number;
  order?: number; // drawn later where it is higher
}

/** Segments by pairs of points, as one object that is drawn at once. */
export function fatLines(ends: Vector[], { width, color = 0xffffff, colors, opacity = 1, order = 3 }: LineLook): LineSegments2 {
  const geometry = new LineSegmentsGeometry().setPositions(new Float32Array(ends.flat()));
  if (colors) geometry.setColors(new Float32Array(colors.flatMap((each) => each.toArray())));
  const material = new LineMaterial({
    color: colors ? 0xffffff : color,
    vertexColors: colors !== undefined,
    linewidth: width,
    transparent: true,
    opacity,
    depthWrite: opacity === 1,
  });
  const lines = unpickable(new LineSegments2(geometry, material));
  lines.renderOrder = order;
  return lines;
}

/** A line through points as pairs of them. */
export const segmentsOf = <Point>(points: Point[]): Point[] =>
  points.slice(1).flatMap((point, i) => [points[i]!, point]);
