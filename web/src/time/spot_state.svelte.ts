// A spot of the map that was clicked, and the pictures that show it.

import { secondsBetween } from '../api/map_files';
import type { Vector } from '../api/types';
import type { Workspace } from '../map/workspace.svelte';
import { clockText } from './drive_time';
import type { TimeState } from './time_state.svelte';
import { fetchViews, type View, type Views } from './views';

export class SpotState {
  point: Vector | null = $state.raw(null);
  views: Views | null = $state.raw(null);
  /** Which of the pictures was chosen. */
  chosen: number | null = $state(null);
  /** [stamp] when each drive starts, as far as that is known. */
  private starts: Record<string, string> = $state.raw({});
  private asked = 0;

  constructor(
    private readonly workspace: Workspace,
    private readonly time: TimeState,
  ) {}

  async look(point: Vector | null, mayAsk: boolean): Promise<void> {
    const turn = ++this.asked;
    this.point = point;
    this.views = null;
    this.chosen = null;
    if (!point || !mayAsk) return;
    const views = await fetchViews(this.workspace, point);
    if (turn !== this.asked) return; // another spot was clicked meanwhile
    this.views = views;
    for (const drive of new Set(views.views.map((view) => view.drive)))
      void this.time
        .dataOf(drive)
        .then(({ start }) => start !== null && (this.starts = { ...this.starts, [drive]: start }))
        .catch(() => undefined); // its pictures have no time then
  }

  secondsOf({ drive, time }: View): number | null {
    const start = this.starts[drive];
    return start === undefined ? null : secondsBetween(start, time);
  }

  when(view: View): string {
    const seconds = this.secondsOf(view);
    return seconds === null ? '' : clockText(seconds);
  }

  /** Shows a picture and its time. */
  choose(number: number): void {
    const view = this.views?.views[number];
    if (!view) return;
    this.chosen = number;
    this.time.clock.pause();
    const seconds = this.secondsOf(view);
    if (seconds !== null) this.time.clock.show(view.drive, seconds);
  }

  step(step: 1 | -1): void {
    const count = this.views?.views.length ?? 0;
    if (this.chosen !== null && count > 0) this.choose((this.chosen + step + count) % count);
  }
}
