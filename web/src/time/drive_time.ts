// Times of a drive. The service says them as decimal seconds of nine digits, which no double holds; the page counts
// seconds since the drive's start.

const kNanoseconds = 1_000_000_000n;

function nanosecondsOf(stamp: string): bigint {
  const [whole = '0', part = ''] = stamp.replace('-', '').split('.');
  const size = BigInt(whole) * kNanoseconds + BigInt(part.padEnd(9, '0').slice(0, 9));
  return stamp.startsWith('-') ? -size : size;
}

/** The stamp that lies `seconds` after another; the way back of secondsBetween. */
export function stampAfter(start: string, seconds: number): string {
  const total = nanosecondsOf(start) + BigInt(Math.round(seconds * 1e9));
  const size = total < 0n ? -total : total;
  return `${total < 0n ? '-' : ''}${size / kNanoseconds}.${String(size % kNanoseconds).padStart(9, '0')}`;
}

/** "0:07.35", "1:02:07.35": how far into the drive. */
export function clockText(seconds: number): string {
  const hundredths = Math.max(0, Math.round(seconds * 100));
  const pad = (value: number) => String(value).padStart(2, '0');
  const [hours, minutes] = [Math.floor(hundredths / 360_000), Math.floor(hundredths / 6000) % 60];
  const rest = `${pad(Math.floor(hundredths / 100) % 60)}.${pad(hundredths % 100)}`;
  return hours > 0 ? `${hours}:${pad(minutes)}:${rest}` : `${minutes}:${rest}`;
}

/** How far a picture was taken off the time that is shown: "+12 ms", "−0.41 s". */
export function offsetText(seconds: number): string {
  const sign = seconds < 0 ? '−' : '+';
  const size = Math.abs(seconds);
  return size < 0.0995 ? `${sign}${Math.round(size * 1000)} ms` : `${sign}${size.toFixed(2)} s`;
}

/** A time on an axis whose ticks are `step` [s] apart: "0:05", "1:00.5". */
export function tickText(seconds: number, step: number): string {
  const digits = step < 0.1 ? 2 : step < 1 ? 1 : 0;
  const scale = 10 ** digits;
  const total = Math.round(Math.abs(seconds) * scale);
  const rest = ((total % (60 * scale)) / scale).toFixed(digits).padStart(digits > 0 ? digits + 3 : 2, '0');
  return `${seconds < 0 && total > 0 ? '−' : ''}${Math.floor(total / (60 * scale))}:${rest}`;
}
