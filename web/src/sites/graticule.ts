// Lines of equal longitude and latitude, as many as a view can bear: the ground of a map without pictures of the Earth.

import type { LonLat } from './site_outline';

export interface GraticuleLine {
  at: number; // [degrees]
  isMeridian: boolean;
  line: LonLat[];
}

const kLines = 8; // across the view, about
const kNorthmost = 85; // the map's projection ends there
const kSteps = [90, 45, 30, 15, 10, 5, 2, 1];

/** [degrees] between lines, for a view that is `span` degrees across. */
export function stepFor(span: number): number {
  const wanted = span / kLines;
  const whole = kSteps.findLast((step) => step >= wanted);
  if (wanted > 0.5) return whole ?? 90;
  const power = 10 ** Math.ceil(Math.log10(wanted));
  const factor = [0.2, 0.5, 1].find((candidate) => candidate * power >= wanted * (1 - 1e-9)) ?? 1;
  return Number((factor * power).toPrecision(1));
}

export function graticuleOf([west, south, east, north]: readonly [number, number, number, number]): GraticuleLine[] {
  const step = stepFor(east - west);
  const lines: GraticuleLine[] = [];
  const [bottom, top] = [Math.max(south - step, -kNorthmost), Math.min(north + step, kNorthmost)];
  const rounded = (value: number) => Number(value.toFixed(6));
  for (let i = Math.floor(west / step); i <= Math.ceil(east / step); ++i) {
    const at = rounded(i * step);
    lines.push({ at, isMeridian: true, line: [[at, bottom], [at, top]] });
  }
  for (let i = Math.ceil(bottom / step); i <= Math.floor(top / step); ++i) {
    const at = rounded(i * step);
    lines.push({ at, isMeridian: false, line: [[west - step, at], [east + step, at]] });
  }
  return lines;
}

/** "11.5760° E" */
export function degreesText(at: number, isMeridian: boolean, step: number): string {
  const digits = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const side = isMeridian ? (at < 0 ? 'W' : 'E') : at < 0 ? 'S' : 'N';
  return `${Math.abs(at).toFixed(digits)}° ${side}`;
}
