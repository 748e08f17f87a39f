// What is chosen, in an address: "slot:L1-07@12.30,-4.00,0.10".

import type { Vector } from '../api/types';
import type { Selection } from './workspace.svelte';

const kKinds = ['point', 'slot', 'loop', 'comment', 'measurement'] as const;

export function textOfSelection(selection: Selection): string {
  const id = selection.kind === 'point' ? '' : selection.id;
  const place = selection.point ? `@${selection.point.map((value) => value.toFixed(2)).join(',')}` : '';
  return `${selection.kind}:${id}${place}`;
}

/** Null where the text chooses nothing. */
export function selectionOfText(text: string | null): Selection | null {
  const [, word, id, place] = /^(\w+):([^@]*)(?:@([-\d.,]+))?$/.exec(text ?? '') ?? [];
  const kind = kKinds.find((known) => known === word);
  const numbers = place?.split(',').map(Number) ?? [];
  const point = numbers.length === 3 && numbers.every(Number.isFinite) ? (numbers as Vector) : null;
  if (!kind || id === undefined) return null;
  if (kind === 'comment') return id === '' ? null : { kind, id, point };
  if (!point) return null;
  if (kind === 'point') return { kind, point };
  return id === '' ? null : { kind, id, point };
}
