// Which layers are shown, and how, in an address: only what differs from the usual.

import { kPathColors, type PathColor } from '../scene/layers/path_colors';

const kLayerNames = [
  'ground', 'free', 'ortho', 'slots', 'markings', 'kerbs', 'surfaces', 'paths', 'keyframes', 'loops', 'links', 'gnss',
] as const;
export type LayerName = (typeof kLayerNames)[number];

export type Shown = Record<LayerName, boolean>;

const kUsual: readonly LayerName[] = ['ground', 'free', 'slots', 'kerbs', 'paths'];
export const usualLayers = () => Object.fromEntries(kLayerNames.map((name) => [name, kUsual.includes(name)])) as Shown;

/** "-slots,links": slots are hidden and links shown, other than usual; null: all is as usual. */
export function textOfLayers(shown: Shown): string | null {
  const differing = kLayerNames.filter((name) => shown[name] !== kUsual.includes(name));
  return differing.length === 0 ? null : differing.map((name) => (shown[name] ? name : `-${name}`)).join(',');
}

/** Names that nobody knows are passed over. */
export function layersOfText(text: string | null): Shown {
  const shown = usualLayers();
  for (const part of (text ?? '').split(',')) {
    const name = kLayerNames.find((known) => known === part.replace(/^-/, ''));
    if (name) shown[name] = !part.startsWith('-');
  }
  return shown;
}

export const kGroundColors = ['picture', 'height', 'slope', 'sigma', 'session', 'age'] as const;
export type GroundColor = (typeof kGroundColors)[number];

export const groundColorOfText = (text: string | null): GroundColor => kGroundColors.find((known) => known === text) ?? 'picture';
export const pathColorOfText = (text: string | null): PathColor => kPathColors.find((known) => known === text) ?? 'drive';

export const textOfSlice = ({ low, high }: { low: number; high: number }) => `${low.toFixed(2)},${high.toFixed(2)}`;

export function sliceOfText(text: string | null): { low: number; high: number } | null {
  const [low, high, ...rest] = (text ?? '').split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
  if (low === undefined || high === undefined || rest.length > 0 || !Number.isFinite(low) || !Number.isFinite(high)) return null;
  return low < high ? { low, high } : null;
}
