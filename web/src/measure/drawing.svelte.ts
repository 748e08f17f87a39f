// The measurement that is being drawn.

import type { Vector } from '../api/types';
import { kPointsOf, valueOf, type Kind } from './geometry';

export class Drawing {
  kind: Kind = $state('distance');
  points: Vector[] = $state.raw([]);
  /** Where the next point would be. */
  candidate: Vector | null = $state.raw(null);
  /** Whether it takes no more points. */
  isDone = $state(false);

  /** What it would be if the candidate were its last point. */
  readonly shown: Vector[] = $derived(this.candidate && !this.isDone ? [...this.points, this.candidate] : this.points);
  readonly value: number | null = $derived(valueOf(this.kind, this.shown));
  readonly canEnd: boolean = $derived(!this.isDone && valueOf(this.kind, this.points) !== null);

  begin(kind: Kind): void {
    this.kind = kind;
    this.clear();
  }

  add(point: Vector): void {
    if (this.isDone) return;
    this.points = [...this.points, point];
    if (this.points.length === kPointsOf[this.kind].most) this.end();
  }

  removeLast(): void {
    if (!this.isDone) this.points = this.points.slice(0, -1);
  }

  end(): void {
    if (valueOf(this.kind, this.points) === null) return;
    this.isDone = true;
    this.candidate = null;
  }

  clear(): void {
    this.points = [];
    this.candidate = null;
    this.isDone = false;
  }
}
