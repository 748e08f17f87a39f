// Decks of a garage, by the levels of its free space.

import type { Collection, FreeSpaceProperties } from '../api/map_files';

export interface Deck {
  level: number; // 0 is the lowest
  low: number; // [m] in site, of its ground
  high: number;
  mean: number;
  area: number; // [m²]
}

const kAbove = 1.3; // [m] of what belongs to a deck and stands above its ground: drives, cameras
const kBelow = 0.3; // [m]
const kClearAbove = 1.1; // [m] above the mean of the deck below: what stands on it must not show
const kClear = 0.6; // [m] below the mean of the next deck: its ground must not show

/** One for each level, the lowest first. */
export function decksOf(freeSpace: Collection<FreeSpaceProperties>): Deck[] {
  const decks = new Map<number, Deck>();
  for (const { properties } of freeSpace.features) {
    const { level, area_m2: area, min_height_m: low, max_height_m: high, mean_height_m: mean } = properties;
    const deck = decks.get(level);
    if (!deck) {
      decks.set(level, { level, low, high, mean, area });
      continue;
    }
    deck.mean = (deck.mean * deck.area + mean * area) / Math.max(deck.area + area, 1e-9);
    deck.area += area;
    deck.low = Math.min(deck.low, low);
    deck.high = Math.max(deck.high, high);
  }
  return [...decks.values()].sort((a, b) => a.level - b.level);
}

/** The heights that show a deck with its ramps, and not the ones above and below. */
export function sliceOf(decks: Deck[], level: number): { low: number; high: number } | null {
  const at = decks.findIndex((deck) => deck.level === level);
  const deck = decks[at];
  if (!deck) return null;
  const [below, above] = [decks[at - 1], decks[at + 1]];
  return {
    low: Math.min(Math.max(deck.low - kBelow, below ? below.mean + kClearAbove : -Infinity), deck.mean - kBelow),
    high: Math.max(Math.min(deck.high + kAbove, above ? above.mean - kClear : Infinity), deck.mean + kBelow),
  };
}

const kLeastHalf = 0.1; // [m]

/** The heights that a deck's colors spread over: its floor, without the ramps that lead to it. */
export function floorOf({ low, high, mean }: Deck): { low: number; high: number } {
  const half = Math.max(2 * Math.min(mean - low, high - mean), kLeastHalf);
  return { low: Math.max(low, mean - half), high: Math.min(high, mean + half) };
}
