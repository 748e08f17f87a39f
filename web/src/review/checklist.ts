// The checklist of a version, as the service keeps it for all reviewers.

import type { Schemas } from '../api/client';

export type ChecklistItem = Schemas['ChecklistItem'];
export type ChecklistEntry = Schemas['ChecklistEntry'];

/** The line breaks of a text are its items; each stands once. One whose text stays keeps its id, and with it its ticks. */
export function itemsOfText(text: string, before: readonly ChecklistItem[]): { id?: string; text: string }[] {
  const lines = text.split('\n').map((line) => line.replace(/^\s*-\s*/, '').trim());
  return [...new Set(lines)]
    .filter((line) => line !== '')
    .map((line) => {
      const known = before.find((item) => item.text === line);
      return known ? { id: known.id, text: line } : { text: line };
    });
}

export const openOnes = (entries: readonly ChecklistEntry[]): ChecklistEntry[] => entries.filter(({ ticked_by: by }) => by === null);

/** What a list came to, in a few words: "4 of 5 ticked". */
export const wordsOfTicks = (entries: readonly ChecklistEntry[]): string =>
  entries.length === 0 ? 'no checklist' : `${entries.length - openOnes(entries).length} of ${entries.length} ticked`;
