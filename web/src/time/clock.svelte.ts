// The time that is shown of a drive. It lives in the workspace, and in the address, which is written now and then only:
// browsers refuse an address that changes with every frame.

import type { Workspace } from '../map/workspace.svelte';
import { Throttle } from './throttle';

const kAddressPause = 500; // [ms]
const kLongestFrame = 1; // [s] after a longer pause of the page it goes on from where it was

export const kSpeeds = [0.5, 1, 2, 4, 8] as const;

export class Clock {
  isPlaying = $state(false);
  speed: number = $state(1);
  /** [s] of the drive, once that is known. */
  end = $state(0);
  private frame = 0;
  private shown = 0; // [ms] when the last frame was
  private readonly address: Throttle<{ drive: string; seconds: number }>;

  constructor(private readonly workspace: Workspace) {
    this.address = new Throttle(({ drive, seconds }) => this.workspace.setTime(drive, seconds), kAddressPause);
  }

  get drive(): string | null {
    return this.workspace.time?.drive ?? this.workspace.drives[0]?.id ?? null;
  }

  get seconds(): number {
    return this.workspace.time?.seconds ?? 0;
  }

  /** Shows a time of the drive that is shown. */
  seek(seconds: number): void {
    if (this.drive !== null && this.end > 0) this.show(this.drive, Math.min(this.end, Math.max(0, seconds)));
  }

  /** Shows a time of a drive, maybe another one. */
  show(drive: string, seconds: number): void {
    this.workspace.time = { drive, seconds };
    this.address.call({ drive, seconds });
  }

  toggle(): void {
    if (this.isPlaying) this.pause();
    else this.play();
  }

  play(): void {
    if (this.isPlaying || this.end <= 0) return;
    if (this.seconds >= this.end - 0.05) this.seek(0); // from the beginning again
    this.isPlaying = true;
    this.shown = performance.now();
    this.frame = requestAnimationFrame((now) => this.tick(now));
  }

  pause(): void {
    cancelAnimationFrame(this.frame);
    this.isPlaying = false;
    this.address.flush();
  }

  private tick(now: number): void {
    const passed = Math.min(kLongestFrame, Math.max(0, (now - this.shown) / 1000));
    this.shown = now;
    this.seek(this.seconds + passed * this.speed);
    if (this.seconds >= this.end) this.pause();
    else this.frame = requestAnimationFrame((next) => this.tick(next));
  }
}
