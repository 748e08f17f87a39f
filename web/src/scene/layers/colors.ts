// Colors of the layers. Each of a pair that must be told apart differs in lightness too.

import type { SlotState } from '../../api/map_files';

export const kSlotColors: Record<SlotState, number> = { free: 0x43d69b, occupied: 0xe0554f, unseen: 0x9aa4b2 };
export const kFreeSpace = 0x5fe3ff;
export const kMarking = 0xff5fd2; // unlike any paint, so that it stands out on what it outlines
export const kKerb = 0xff8a1f;
export const kSpeedBump = 0xffd23f;
export const kAccepted = 0x37d67a;
export const kRejected = 0xff5d5d;
export const kOpen = 0xc3ccd8; // neither
export const kUnknown = 0x8a93a0;
export const kCasing = 0x0b1018; // around lines, so that they show on any ground

/** Of what lies beside free space; a class that is not named is drawn as structure. */
export const kSurfaceColors: Record<string, number> = {
  pavement: 0xc9a2d6,
  vegetation: 0x4fa64b,
  kerb: 0xf2c230,
  vehicle: 0x3f6fe0,
  person: 0xe0554f,
  structure: 0x8a94a3,
};

export const cssOf = (color: number) => `#${color.toString(16).padStart(6, '0')}`;
