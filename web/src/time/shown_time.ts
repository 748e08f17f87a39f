// Which times' pictures are asked for. While it plays they lie on a grid, so that the next one can be got ready.

const kGrid = 0.2; // [s] of the page between two pictures

export interface ShownTime {
  now: number; // [s] of the drive
  ahead: number | null;
}

export function shownTime(seconds: number, isPlaying: boolean, speed: number): ShownTime {
  if (!isPlaying) return { now: seconds, ahead: null };
  const step = kGrid * Math.max(1, speed);
  const passed = Math.floor(seconds / step + 1e-9);
  return { now: passed * step, ahead: (passed + 1) * step };
}
