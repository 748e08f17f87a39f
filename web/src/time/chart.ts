// One plot over time on a canvas, by uPlot. The page draws the cursor and the playhead of all plots itself.

import 'uplot/dist/uPlot.min.css';

import uPlot from 'uplot';

import { tickText } from './drive_time';
import { rangeOf, type Degraded, type Plot, type Window } from './plot_model';

export interface ChartColors {
  grid: string;
  text: string;
  doubt: string;
  lines: string[];
}

export interface ChartEvents {
  hover: (seconds: number | null) => void;
  seek: (seconds: number) => void;
  brush: (window: Window) => void;
  reset: () => void;
}

export const kAxisWidth = 46; // [px] left of every plot, so that their times lie below each other
const kSteady = 4; // [px] by which a pointer may move in a click

/** Increments that are round on a clock, [s]. */
const kSteps = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600];

export class Chart {
  private readonly plot: uPlot;
  private window: Window;

  /** Without a plot it is the ruler that all plots share. */
  constructor(place: HTMLElement, size: { width: number; height: number }, window: Window, plot: Plot | null,
    colors: ChartColors, private readonly degraded: readonly Degraded[], private readonly events: ChartEvents) {
    this.window = window;
    const data = plot
      ? uPlot.join(plot.lines.map(({ times, values }) => [times, values] as uPlot.AlignedData))
      : ([[...window], [null, null]] as uPlot.AlignedData);
    this.plot = new uPlot(
      {
        ...size,
        legend: { show: false },
        padding: [plot ? 4 : 0, 0, plot ? 4 : 0, 0],
        cursor: {
          x: false, y: false, points: { show: false },
          drag: { x: true, y: false, setScale: false, dist: kSteady },
          bind: { dblclick: () => () => (this.events.reset(), null) },
        },
        scales: {
          x: { time: false, range: () => [...this.window] },
          y: { range: (_plot, low, high) => rangeOf(low, high, plot?.isSize ?? true) },
        },
        series: [
          {},
          ...(plot ? plot.lines : [null]).map((line, i) => ({
            stroke: colors.lines[i] ?? colors.text,
            width: 1.25,
            points: { show: (line?.times.length ?? 0) < 2 },
          })),
        ],
        axes: [
          {
            side: 0, size: plot ? 0 : size.height, gap: 2, stroke: colors.text, font: kFont, incrs: kSteps, space: 70,
            grid: { stroke: colors.grid, width: 1, show: plot !== null },
            ticks: { show: plot === null, stroke: colors.grid, size: 4 },
            values: (_plot, splits, _axis, _space, step) => splits.map((split) => (plot ? '' : tickText(split, step))),
          },
          {
            size: kAxisWidth, gap: 4, stroke: colors.text, font: kFont, space: 22,
            grid: { stroke: colors.grid, width: 1, show: plot !== null }, ticks: { show: false },
            ...(plot ? {} : { values: (_plot, splits) => splits.map(() => '') }),
          },
        ],
        hooks: {
          drawClear: [(drawn) => this.shade(drawn, colors.doubt)],
          setCursor: [({ cursor: { left } }) => this.events.hover(left === undefined || left < 0 ? null : this.plot.posToVal(left, 'x'))],
          setSelect: [
            (drawn) => {
              const { left, width } = drawn.select;
              if (width <= kSteady) return;
              drawn.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
              this.events.brush([drawn.posToVal(left, 'x'), drawn.posToVal(left + width, 'x')]);
            },
          ],
        },
      },
      data,
      place,
    );
    this.watchClicks();
  }

  set shown(window: Window) {
    this.window = window;
    this.plot.setScale('x', { min: window[0], max: window[1] });
  }

  destroy(): void {
    this.plot.destroy();
  }

  private watchClicks(): void {
    const { over } = this.plot;
    let pressed: number | null = null;
    over.addEventListener('pointerdown', (event) => (pressed = event.button === 0 ? event.clientX : null));
    over.addEventListener('pointerup', (event) => {
      if (pressed === null || Math.abs(event.clientX - pressed) > kSteady) return;
      this.events.seek(this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, 'x'));
    });
  }

  /** Stretches that are less sure, at least a pixel wide. */
  private shade(drawn: uPlot, color: string): void {
    const { ctx, bbox } = drawn;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.fillStyle = color;
    for (const { begin, end } of this.degraded) {
      const [left, right] = [drawn.valToPos(begin, 'x', true), drawn.valToPos(end, 'x', true)];
      if (right >= bbox.left && left <= bbox.left + bbox.width)
        ctx.fillRect(left, bbox.top, Math.max(devicePixelRatio, right - left), bbox.height);
    }
    ctx.restore();
  }
}

const kFont = '11px system-ui, sans-serif';
