// Colors of lines, as a canvas needs them: from the palette of the scene and from the page's theme.

import { kPalette } from '../scene/ground_look';
import type { ChartColors } from './chart';
import type { Plot } from './plot_model';

/** Of a camera, the same in plots, captions and frusta. */
export const cameraColor = (number: number): number => kPalette[number % kPalette.length]!;

/** Of a palette's color as text and lines on the page: darker on a light page, lighter on a dark one. */
export const onPage = (color: number): string => `color-mix(in oklab, #${color.toString(16).padStart(6, '0')} 72%, var(--text))`;

/** Colors by what they are for, as the theme has them where an element is. */
export class ThemeColors {
  constructor(private readonly probe: HTMLElement) {}

  of(color: string): string {
    this.probe.style.color = color;
    return getComputedStyle(this.probe).color;
  }

  chart(plot: Plot | null, cameras: readonly string[]): ChartColors {
    return {
      grid: this.of('var(--line)'),
      text: this.of('var(--quiet)'),
      doubt: this.of('color-mix(in srgb, var(--warn) 20%, transparent)'),
      lines: (plot?.lines ?? []).map(({ camera }, i) => this.of(lineColor(camera, i, cameras))),
    };
  }
}

/** Lines of cameras have their camera's color; others the accent, and a second one beside it. */
export function lineColor(camera: string | null, number: number, cameras: readonly string[]): string {
  if (camera !== null) return onPage(cameraColor(Math.max(0, cameras.indexOf(camera))));
  return number === 0 ? 'var(--accent)' : onPage(kPalette[1]!);
}
