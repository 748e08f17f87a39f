// Comments as threads, and what they are pinned to. No page in here.

import type { Schemas } from '../api/client';
import type { Comment } from '../api/types';
import type { Selection } from '../map/workspace.svelte';

export type CommentPin = Schemas['CommentPin'];

export interface Thread {
  number: number; // the oldest is 1
  first: Comment;
  answers: Comment[]; // oldest first
  isOpen: boolean;
}

const byAge = (a: Comment, b: Comment) => a.created_at.localeCompare(b.created_at) || a.id.localeCompare(b.id);

/** Threads of a version, oldest first. */
export function threadsOf(comments: Comment[]): Thread[] {
  const answers = new Map<string, Comment[]>();
  for (const comment of comments)
    if (comment.thread !== null) answers.set(comment.thread, [...(answers.get(comment.thread) ?? []), comment]);
  return comments
    .filter(({ thread }) => thread === null)
    .sort(byAge)
    .map((first, i) => ({
      number: i + 1,
      first,
      answers: (answers.get(first.id) ?? []).sort(byAge),
      isOpen: first.resolved_at === null,
    }));
}

/** As lists show them: what is open first, and in that the newest. */
export function inOrder(threads: Thread[]): Thread[] {
  return [...threads].sort((a, b) => Number(b.isOpen) - Number(a.isOpen) || b.number - a.number);
}

/** What a comment on what is chosen is pinned to; null where that is nothing to comment on. */
export function pinOfSelection(selection: Selection | null): CommentPin | null {
  switch (selection?.kind) {
    case 'point': return { point: selection.point };
    case 'measurement': return { point: selection.point };
    case 'slot': return { slot: selection.id };
    case 'loop': return { loop: selection.id };
    default: return null;
  }
}

/** What a thread is about, in a few words. `driveName` says how a drive is called, `start` when its plots begin. */
export function wordsOfPin(pin: CommentPin | null, driveName: (id: string) => string, start: (id: string) => number | null): string {
  if (pin?.point) return `at ${pin.point.map((value) => value.toFixed(1)).join(', ')} m`;
  if (pin?.slot !== undefined) return `slot ${pin.slot.replace(/^slot_/, '')}`;
  if (pin?.loop !== undefined) return `loop ${pin.loop}`;
  if (pin?.drive === undefined) return 'the whole version';
  const begin = start(pin.drive);
  if (pin.time === undefined || begin === null) return driveName(pin.drive);
  return `${driveName(pin.drive)} at ${(pin.time - begin).toFixed(1)} s`;
}
