import { expect, test } from 'vitest';

import { titleOf } from './titles';

test('titles begin with what tells a tab from another', () => {
  expect(titleOf({ name: 'sites' })).toBe('Sites · Parkade');
  expect(titleOf({ name: 'map', site: 'lot', version: '2' })).toBe('lot, version 2 · Parkade');
  expect(titleOf({ name: 'map', site: 'lot', version: 'latest' })).toBe('lot, latest version · Parkade');
  expect(titleOf({ name: 'settings', section: 'audit' })).toBe('Audit log · Settings · Parkade');
  expect(titleOf({ name: 'settings', section: 'nothing' })).toBe('Settings · Parkade');
});
