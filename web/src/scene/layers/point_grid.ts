// Points in squares, to find those near a place.

import type { Vector } from '../../api/types';

export class PointGrid {
  private readonly squares = new Map<number, number[]>();

  /** `size` [m] of a square: about how far is looked. */
  constructor(
    private readonly points: ArrayLike<number>, // x, y, z of each
    private readonly size: number,
  ) {
    for (let i = 0; 3 * i < points.length; ++i) {
      const key = this.keyOf(Math.floor(points[3 * i]! / size), Math.floor(points[3 * i + 1]! / size));
      const square = this.squares.get(key);
      if (square) square.push(i);
      else this.squares.set(key, [i]);
    }
  }

  /** Index of the nearest point within `reach` [m] across, at most one size, and `storey` [m] up or down; -1: none. */
  nearest([x, y, z]: Vector, reach: number, storey: number): number {
    const [column, row] = [Math.floor(x / this.size), Math.floor(y / this.size)];
    let [best, least] = [-1, reach * reach];
    for (let i = column - 1; i <= column + 1; ++i)
      for (let j = row - 1; j <= row + 1; ++j)
        for (const index of this.squares.get(this.keyOf(i, j)) ?? []) {
          if (Math.abs(this.points[3 * index + 2]! - z) > storey) continue;
          const [dx, dy] = [this.points[3 * index]! - x, this.points[3 * index + 1]! - y];
          const distance = dx * dx + dy * dy;
          if (distance <= least) [best, least] = [index, distance];
        }
    return best;
  }

  private keyOf(column: number, row: number): number {
    return column * 0x200000 + row; // exact for a thousand kilometers of squares of a meter
  }
}
