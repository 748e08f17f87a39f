// How fast bytes go, over the last seconds, and when they will all have gone.

const kWindow = 8000; // [ms]

export class TransferRate {
  private samples: { time: number; bytes: number }[] = [];

  /** `bytes` in all have gone at `time`, [ms]. */
  add(time: number, bytes: number): void {
    const last = this.samples.at(-1);
    if (last && bytes < last.bytes) this.samples = []; // it began again from further back
    this.samples.push({ time, bytes });
    // One sample from before the window stays, so that a slow line has a rate, too.
    while (this.samples.length > 2 && this.samples[1]!.time <= time - kWindow) this.samples.shift();
  }

  reset(): void {
    this.samples = [];
  }

  /** [bytes/s]; null while that is not known. */
  get bytesPerSecond(): number | null {
    const [first, last] = [this.samples[0], this.samples.at(-1)];
    if (!first || !last || last.time - first.time < 500) return null;
    return ((last.bytes - first.bytes) * 1000) / (last.time - first.time);
  }

  /** [s] until `bytes` more have gone; null where nobody can say. */
  secondsFor(bytes: number): number | null {
    const rate = this.bytesPerSecond;
    return rate === null || rate <= 0 ? null : bytes / rate;
  }
}
