// Points in time as people say them.

const kMinute = 60;
const kHour = 3600;
const kDay = 86_400;

/** "just now", "5 min ago", "in 3 days"; [ms] since the epoch. */
export function sayWhen(iso: string, now = Date.now()): string {
  const seconds = (Date.parse(iso) - now) / 1000;
  const off = Math.abs(seconds);
  if (off < kMinute) return seconds > 0 ? 'in a minute' : 'just now';
  const [count, unit] =
    off < kHour ? [off / kMinute, 'min'] : off < 2 * kDay ? [off / kHour, 'h'] : [off / kDay, 'days'];
  // What was made for 90 days ends in 90 days, a second later, too.
  return seconds > 0 ? `in ${Math.round(count)} ${unit}` : `${Math.floor(count)} ${unit} ago`;
}

/** "2026-11-27 18:49", here: it sorts, and no reader takes the month for the day. */
export function sayTime(iso: string): string {
  const time = new Date(iso);
  const pad = (value: number) => String(value).padStart(2, '0');
  return `${time.getFullYear()}-${pad(time.getMonth() + 1)}-${pad(time.getDate())} ${pad(time.getHours())}:${pad(time.getMinutes())}`;
}
