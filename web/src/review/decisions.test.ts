import { expect, test } from 'vitest';

import { decisionsFor } from './decisions';

const actions = (state: Parameters<typeof decisionsFor>[0]) => decisionsFor(state).map(({ action }) => action);

test('a state allows what the service does', () => {
  expect(actions('draft')).toEqual(['submit', 'comment']);
  expect(actions('in_review')).toEqual(['approve', 'reject', 'comment']);
  expect(actions('approved')).toEqual(['reopen', 'reject', 'comment']);
  expect(actions('rejected')).toEqual(['reopen', 'comment']);
});

test('nobody rejects without a reason', () => {
  expect(decisionsFor('in_review').map(({ action, needsReason }) => [action, needsReason])).toEqual([
    ['approve', false], ['reject', true], ['comment', true],
  ]);
});
