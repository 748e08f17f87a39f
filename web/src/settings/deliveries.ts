// How a delivery to a webhook went, in words.

import type { Schemas } from '../api/client';
import { sayWhen } from '../ui/when';

type Delivery = Pick<Schemas['Delivery'], 'state' | 'attempts' | 'due_at' | 'status' | 'duration_ms' | 'error'>;

const kStates = {
  waiting: { state: 'waits', kind: 'warn' },
  delivered: { state: 'delivered', kind: 'good' },
  failed: { state: 'given up', kind: 'bad' },
} as const;

export function outcomeOf({ state, attempts, due_at, status, duration_ms, error }: Delivery, now = Date.now()) {
  const parts: string[] = [];
  if (attempts > 0) parts.push(attempts === 1 ? 'tried once' : `tried ${attempts} times`);
  if (status !== null) parts.push(`answered ${status}${duration_ms === null ? '' : ` after ${duration_ms} ms`}`);
  if (error !== null && error !== '') parts.push(error);
  if (state === 'waiting') parts.push(due_at === null || Date.parse(due_at) <= now ? 'is being sent' : `next try ${sayWhen(due_at, now)}`);
  return { ...kStates[state], text: parts.join(' · ') };
}
