import { expect, test } from 'vitest';

import { outcomeOf } from './deliveries';

const kNow = Date.parse('2026-11-27T12:00:00Z');

test('a delivery says how it went and what comes', () => {
  const sent = { state: 'delivered', attempts: 1, due_at: null, status: 204, duration_ms: 31, error: null } as const;
  expect(outcomeOf(sent, kNow)).toEqual({ state: 'delivered', kind: 'good', text: 'tried once · answered 204 after 31 ms' });
  const waiting = { state: 'waiting', attempts: 2, due_at: '2026-11-27T12:05:00Z', status: null, duration_ms: null, error: 'no answer' } as const;
  expect(outcomeOf(waiting, kNow).text).toBe('tried 2 times · no answer · next try in 5 min');
  expect(outcomeOf({ ...waiting, attempts: 0, error: null, due_at: '2026-11-27T11:59:59Z' }, kNow).text).toBe('is being sent');
});
