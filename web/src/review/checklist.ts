// What a reviewer looks at before a map may steer cars. A site may have its own list: lines below "Review checklist:"
// in its note, each with a dash before it, up to the first other line. They are plain text, for people without this page, too.

export const kUsual = {
  coverage: 'Coverage looked at: no gap where cars will drive',
  degraded: 'Degraded stretches looked at',
  loops: 'Loops looked at',
  changes: 'Changes against the approved version stepped through',
  slots: 'Slots sampled: shape and state are right',
} as const;
export type UsualItem = keyof typeof kUsual;

const kHead = 'Review checklist:';
const kMostItems = 30;

/** A site's own items; null where its note has none. */
export function itemsIn(note: string): string[] | null {
  const block = blockOf(note.split('\n'));
  if (!block) return null;
  const items = block.lines.map((line) => line.replace(/^\s*-\s*/, '').trim()).filter((item) => item !== '');
  return items.length === 0 ? null : [...new Set(items)].slice(0, kMostItems);
}

/** The note with these items in place of those that it had; none: with none. */
export function noteWith(note: string, items: string[]): string {
  const lines = note.split('\n');
  const block = blockOf(lines);
  const rest = block ? [...lines.slice(0, block.begin), ...lines.slice(block.end)] : lines;
  const text = rest.join('\n').replace(/\n{3,}/g, '\n\n').trim();
  if (items.length === 0) return text;
  const list = [kHead, ...items.map((item) => `- ${item}`)].join('\n');
  return text === '' ? list : `${text}\n\n${list}`;
}

function blockOf(lines: string[]): { begin: number; end: number; lines: string[] } | null {
  const begin = lines.findIndex((line) => line.trim().toLowerCase() === kHead.toLowerCase());
  if (begin < 0) return null;
  const after = lines.slice(begin + 1).findIndex((line) => !/^\s*-/.test(line));
  const end = after < 0 ? lines.length : begin + 1 + after;
  return { begin, end, lines: lines.slice(begin + 1, end) };
}

/** Lines that people typed, as items. */
export const itemsOfText = (text: string) =>
  [...new Set(text.split('\n').map((line) => line.replace(/^\s*-\s*/, '').trim()).filter((line) => line !== ''))].slice(0, kMostItems);

/** What a decision's reason says about the list. */
export function wordsOfTicks(items: readonly string[], isTicked: (item: string) => boolean): string {
  const line = (item: string) => `${isTicked(item) ? '[x]' : '[ ]'} ${item}`;
  return items.map(line).join('\n');
}
