// What happens at the service, as it happens.

import { addressOf } from './client';

export type EventKind = 'job' | 'map' | 'drive' | 'review' | 'comment';

/** One connection for the whole page, opened for the first who listens and closed after the last. */
let source: EventSource | null = null;
const listeners = new Set<{ kinds: readonly EventKind[]; onChange: () => void }>();

const kKinds: readonly EventKind[] = ['job', 'map', 'drive', 'review', 'comment'];

let isOffered = true;

/** Whether this caller is told of events: by a share link nobody is. To be said before the page is shown. */
export function offerEvents(is: boolean): void {
  isOffered = is;
}

function open(): void {
  source = new EventSource(addressOf('get', '/api/v1/events'));
  for (const kind of kKinds)
    source.addEventListener(kind, () => {
      for (const listener of listeners) if (listener.kinds.includes(kind)) listener.onChange();
    });
  // What happened while it was not connected is not told again.
  source.addEventListener('open', () => {
    for (const listener of listeners) listener.onChange();
  });
}

/** Calls `onChange` after each change of these kinds, and after each reconnection. Returns what ends it. */
export function watchEvents(kinds: readonly EventKind[], onChange: () => void): () => void {
  const listener = { kinds, onChange };
  listeners.add(listener);
  if (!source && isOffered) open();
  return () => {
    listeners.delete(listener);
    if (listeners.size > 0) return;
    source?.close();
    source = null;
  };
}
