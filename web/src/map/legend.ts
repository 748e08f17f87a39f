// What colors in the scene stand for.

export type Legend = { title: string; about: string } & (
  | { kind: 'ramp'; colors: readonly number[]; ticks: string[] } // evenly spread, the lowest first
  | { kind: 'list'; entries: { color: number; label: string }[] }
);

const kMostDigits = 4;

/** Three numbers along a scale, with as many digits as tell them apart and no more than they need. */
export function ticksOf(low: number, high: number, unit: string): string[] {
  const enough = Math.min(kMostDigits, Math.max(0, 1 - Math.floor(Math.log10(Math.max(high - low, 1e-9)))));
  const values = [low, (low + high) / 2, high].map((value) => Number(value.toFixed(enough)) || 0); // nothing is -0
  const digits = Array.from({ length: enough }, (_, i) => i).find((few) => values.every((value) => Number(value.toFixed(few)) === value));
  return values.map((value) => `${value.toFixed(digits ?? enough)} ${unit}`);
}
