// The picture of one camera as time goes on: one question at a time, and after it the latest that is wanted.

import { refusalIn } from '../api/client';
import { secondsBetween } from '../api/map_files';

export interface Picture {
  address: string;
  url: string; // of its bytes, in this page
  time: string; // when it was taken
  width: number; // [px] as recorded
  height: number;
}

/** What there is at an address: a picture, or why there is none, which may pass. */
type Found = Picture | { address: string; complaint: string; mayPass: boolean };

const kKept = 16;
const kPatience = 500; // [ms] for a picture that nobody wants any more

export class PictureFeed {
  picture: Picture | null = $state.raw(null);
  isLoading = $state(false);
  /** Why there is no picture at the time that is wanted. */
  complaint = $state('');
  /** Whether the service still reads the log, so that the picture comes later. */
  isWaiting = $state(false);
  private readonly found = new Map<string, Found>();
  private wanted: string | null = null;
  private ahead: string | null = null;
  private asking: { control: AbortController; since: number } | null = null;
  private isOver = false;

  /** Shows the picture of an address, and gets that of another one ready where it is said. */
  want(address: string, ahead: string | null = null): void {
    const known = this.found.get(address);
    if (known && 'mayPass' in known && known.mayPass) this.found.delete(address);
    this.wanted = address;
    this.ahead = ahead;
    this.showIfThere();
    // While it plays, what is asked for is nearly what is wanted; after a jump it is not.
    if (this.asking && ahead === null && performance.now() - this.asking.since > kPatience) this.asking.control.abort();
    if (!this.asking) void this.ask();
  }

  /** [s] from the time that is wanted to that of the picture. */
  offsetFrom(stamp: string): number | null {
    return this.picture ? secondsBetween(stamp, this.picture.time) : null;
  }

  dispose(): void {
    this.isOver = true;
    this.asking?.control.abort();
    for (const found of this.found.values()) if ('url' in found) URL.revokeObjectURL(found.url);
    this.found.clear();
  }

  private next(): string | null {
    const isNew = (address: string | null): address is string => address !== null && !this.found.has(address);
    return isNew(this.wanted) ? this.wanted : isNew(this.ahead) ? this.ahead : null;
  }

  private async ask(): Promise<void> {
    for (let address = this.next(); address !== null && !this.isOver; address = this.next()) {
      this.isLoading = address === this.wanted;
      const control = new AbortController();
      this.asking = { control, since: performance.now() };
      const found = await this.read(address, control.signal);
      if (found && !this.isOver) this.keep(found);
      else if ('url' in (found ?? {})) URL.revokeObjectURL((found as Picture).url);
      this.showIfThere();
    }
    this.asking = null;
    this.isLoading = false;
  }

  /** Null where it was given up, or has to be asked for again. */
  private async read(address: string, signal: AbortSignal): Promise<Found | null> {
    try {
      const response = await fetch(address, { signal });
      this.isWaiting = response.status === 503;
      if (this.isWaiting) {
        await pause(Number(response.headers.get('retry-after') ?? 2) * 1000, signal);
        return null;
      }
      if (!response.ok) return { address, complaint: refusalIn(await response.text(), response.status), mayPass: response.status >= 500 };
      const [width, height] = (response.headers.get('picture-full-size') ?? '').split('x').map(Number);
      const time = response.headers.get('picture-time') ?? '';
      return { address, url: URL.createObjectURL(await response.blob()), time, width: width || 16, height: height || 10 };
    } catch {
      return signal.aborted ? null : { address, complaint: 'the service does not answer', mayPass: true };
    }
  }

  private keep(found: Found): void {
    this.found.set(found.address, found);
    for (const [address, old] of this.found) {
      if (this.found.size <= kKept) break;
      if (old === this.picture || address === this.wanted) continue;
      this.found.delete(address);
      if ('url' in old) URL.revokeObjectURL(old.url);
    }
  }

  private showIfThere(): void {
    const found = this.wanted === null ? undefined : this.found.get(this.wanted);
    if (!found) return;
    this.complaint = 'complaint' in found ? found.complaint : '';
    this.picture = 'url' in found ? found : null;
  }
}

function pause(milliseconds: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => {
    const timer = setTimeout(resolve, milliseconds);
    signal.addEventListener('abort', () => (clearTimeout(timer), resolve()));
  });
}

const kWidths = [160, 320, 480, 640, 960, 1280, 1920];

/** [px] to ask for where a picture is shown so wide: few sizes, so that the same picture is not asked for again. */
export const widthFor = (shown: number, pixelRatio: number) =>
  kWidths.find((width) => width >= shown * Math.min(2, pixelRatio) * 0.9) ?? kWidths.at(-1)!;
