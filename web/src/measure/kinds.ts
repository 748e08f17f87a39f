// What can be measured, by name and picture.

import type { Kind } from './geometry';

export const kKinds: readonly { kind: Kind; title: string; icon: string }[] = [
  { kind: 'distance', title: 'Distance', icon: 'M4 18 L20 6 M4 14 v4 h4 M20 10 v-4 h-4' },
  { kind: 'area', title: 'Area', icon: 'M5 8 L14 4 L20 13 L12 20 L4 17 Z' },
  { kind: 'height', title: 'Height', icon: 'M12 4 V20 M8 8 L12 4 L16 8 M8 16 L12 20 L16 16' },
  { kind: 'slope', title: 'Slope', icon: 'M3 19 H21 V7 Z' },
  { kind: 'section', title: 'Section', icon: 'M3 16 C7 16 8 8 12 10 S17 15 21 9 M3 20 H21' },
];

export const titleOf = (kind: Kind) => kKinds.find((known) => known.kind === kind)!.title;
