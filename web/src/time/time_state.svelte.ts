// What the panel shows: a drive, the stretch of it that the plots show, and the time under the cursor.

import type { Plots } from '../api/types';
import type { Workspace } from '../map/workspace.svelte';
import { Clock } from './clock.svelte';
import { fetchDriveData, fetchPlotRange, type DriveData } from './drive_data';
import { stampAfter } from './drive_time';
import { isThinned, plotsOf, shows, widened, windowWithin, withStretch, type Window } from './plot_model';
import { nextMoment } from './poses';

const kFinerAfter = 200; // [ms] that a window stays before finer plots are asked for

export class TimeState {
  readonly clock: Clock;
  /** The drive that is shown; null until it is there. */
  data: DriveData | null = $state.raw(null);
  error = $state('');
  /** [s] under the pointer. */
  hovered: number | null = $state(null);
  private zoom: Window | null = $state.raw(null);
  /** A stretch of the drive in full. */
  private stretch: { drive: string; window: Window; plots: Plots } | null = $state.raw(null);
  private readonly asked = new Map<string, Promise<DriveData>>();

  /** To be made while a component is: it ends with that. */
  constructor(private readonly workspace: Workspace) {
    this.clock = new Clock(workspace);
    const drive = $derived(this.clock.drive);
    $effect(() => {
      if (drive !== null) void this.load(drive);
    });
    $effect(() => this.refine());
    $effect(() => {
      if (this.clock.isPlaying && this.zoom) this.turnPage(this.zoom);
    });
    $effect(() => () => this.clock.pause());
  }

  get window(): Window {
    return this.zoom ?? [0, Math.max(this.clock.end, 1e-3)];
  }

  get isZoomed(): boolean {
    return this.zoom !== null;
  }

  readonly plots = $derived.by(() => {
    const { data, stretch } = this;
    const whole = data?.plots?.series ?? [];
    return plotsOf({ series: stretch?.drive === data?.id && stretch ? withStretch(whole, stretch.plots.series) : whole });
  });
  readonly degraded = $derived(this.data?.plots?.degraded ?? []);
  readonly cameras = $derived((this.data?.cameras ?? []).map(({ name }) => name));

  /** What is known of a drive of the map; asked for once. */
  dataOf(id: string): Promise<DriveData> {
    const known = this.asked.get(id);
    if (known) return known;
    const drive = this.workspace.drives.find((other) => other.id === id);
    if (!drive) return Promise.reject(new Error('this drive is not part of the map'));
    const data = fetchDriveData(this.workspace.map, this.workspace.report, drive);
    this.asked.set(id, data);
    return data;
  }

  show(window: Window | null): void {
    const within = window && windowWithin(window, this.clock.end);
    this.zoom = within && within[1] - within[0] < this.clock.end * 0.999 ? within : null;
  }

  /** Narrower or wider about the time that is shown. */
  zoomBy(factor: number): void {
    const [from, to] = this.window;
    const middle = Math.min(to, Math.max(from, this.clock.seconds));
    this.show([middle - (middle - from) * factor, middle + (to - middle) * factor]);
  }

  /** To the keyframes before or after; without keyframes, a fifth of a second. */
  step(step: 1 | -1): void {
    this.clock.pause();
    const { moments } = this.data ?? { moments: [] };
    const next = moments.length > 0 ? nextMoment(moments, this.clock.seconds, step) : this.clock.seconds + 0.2 * step;
    if (next !== null) this.goTo(next);
  }

  /** To the beginning of the stretch before or after that is less sure than the rest. */
  stepDegraded(step: 1 | -1): void {
    const begins = this.degraded.map(({ begin }) => begin);
    const next = nextMoment(begins, this.clock.seconds, step);
    if (next === null) this.clock.pause();
    else this.jump(next);
  }

  /** Stops at a time. */
  jump(seconds: number): void {
    this.clock.pause();
    this.goTo(seconds);
  }

  /** Shows a time, and a window of the plots that has it. */
  goTo(seconds: number): void {
    this.clock.seek(seconds);
    const { zoom } = this;
    if (zoom && (seconds < zoom[0] || seconds > zoom[1])) {
      const half = (zoom[1] - zoom[0]) / 2;
      this.show([seconds - half, seconds + half]);
    }
  }

  private async load(drive: string): Promise<void> {
    if (this.data?.id === drive) return;
    this.clock.pause();
    this.data = null;
    this.zoom = null;
    this.hovered = null;
    this.error = '';
    this.clock.end = this.reportedEnd(drive); // keys mean something before the plots are there
    try {
      const data = await this.dataOf(drive);
      if (this.clock.drive !== drive) return; // another one was chosen meanwhile
      this.clock.end = data.end;
      this.data = data;
      if (this.clock.seconds < 0 || this.clock.seconds > data.end) this.clock.seek(this.clock.seconds); // an address can say anything
    } catch (error) {
      this.error = error instanceof Error ? error.message : String(error);
    }
  }

  private reportedEnd(drive: string): number {
    const name = this.workspace.drives.find(({ id }) => id === drive)?.name;
    return this.workspace.report.drives.find((reported) => reported.name === name)?.duration ?? 0;
  }

  /** The service thins what it answers: of a narrow window it is asked by itself. */
  private refine(): (() => void) | undefined {
    const { zoom, data, stretch } = this;
    if (!zoom || !data?.plots || data.start === null) return;
    if (shows([0, data.end], isThinned(data.plots), zoom)) return;
    if (stretch?.drive === data.id && shows(stretch.window, isThinned(stretch.plots), zoom)) return;
    const [window, start] = [widened(zoom, data.end), data.start];
    const timer = setTimeout(() => {
      fetchPlotRange(this.workspace.map, data.id, stampAfter(start, window[0]), stampAfter(start, window[1]))
        .then((plots) => {
          if (this.zoom === zoom && this.data === data) this.stretch = { drive: data.id, window, plots };
        })
        .catch(() => undefined); // the coarser ones stay
    }, kFinerAfter);
    return () => clearTimeout(timer);
  }

  private turnPage([from, to]: Window): void {
    const { seconds } = this.clock;
    if (seconds < from || seconds > to) this.show([seconds, seconds + (to - from)]);
  }
}
