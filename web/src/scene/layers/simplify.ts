// Fewer points for the same outline: steps of the cells that it was traced along become lines.

import type { Vector } from '../../api/types';

function distanceToLine([x, y]: Vector, [ax, ay]: Vector, [bx, by]: Vector): number {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy);
  return length < 1e-9 ? Math.hypot(x - ax, y - ay) : Math.abs((x - ax) * dy - (y - ay) * dx) / length;
}

/** Douglas and Peucker's: none of the points that are left out lies farther than `tolerance` [m] off, seen from above. */
export function simplified(points: Vector[], tolerance: number): Vector[] {
  if (points.length < 3) return points;
  const isKept = new Uint8Array(points.length);
  isKept[0] = isKept[points.length - 1] = 1;
  const open: [number, number][] = [[0, points.length - 1]];
  for (let range = open.pop(); range; range = open.pop()) {
    const [first, last] = range;
    let [farthest, at] = [tolerance, -1];
    for (let i = first + 1; i < last; ++i) {
      const distance = distanceToLine(points[i]!, points[first]!, points[last]!);
      if (distance > farthest) [farthest, at] = [distance, i];
    }
    if (at < 0) continue;
    isKept[at] = 1;
    open.push([first, at], [at, last]);
  }
  return points.filter((_, i) => isKept[i] === 1);
}
