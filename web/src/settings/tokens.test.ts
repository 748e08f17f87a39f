import { expect, test } from 'vitest';

import { lifeOf, namesIn, sayEnd, warningsOf, type Token } from './tokens';

const kNow = Date.parse('2026-11-27T12:00:00Z');
const token = (changes: Partial<Token> = {}): Token => ({
  id: 'a',
  name: 'anne',
  role: 'admin',
  sites: null,
  pictures: false,
  created_at: '2026-11-01T00:00:00Z',
  expires_at: null,
  revoked_at: null,
  used_at: null,
  ...changes,
});

test('a token works until it ends or is revoked', () => {
  expect(lifeOf(token(), kNow)).toBe('works');
  expect(lifeOf(token({ expires_at: '2026-11-27T12:00:00Z' }), kNow)).toBe('ended');
  expect(lifeOf(token({ expires_at: '2026-12-27T12:00:00Z', revoked_at: '2026-11-27T10:00:00Z' }), kNow)).toBe('revoked');
});

test('its end is said in words', () => {
  expect(sayEnd(token(), kNow)).toBe('no end');
  expect(sayEnd(token({ expires_at: '2026-12-27T12:00:00Z' }), kNow)).toBe('ends in 30 days');
  expect(sayEnd(token({ expires_at: '2026-11-17T12:00:00Z' }), kNow)).toBe('ended 10 days ago');
  expect(sayEnd(token({ revoked_at: '2026-11-27T10:00:00Z' }), kNow)).toBe('revoked 2 h ago');
});

test('revoking the last admin, or oneself, is warned of', () => {
  const last = token();
  const others = [token({ id: 'b', role: 'viewer' }), token({ id: 'c', sites: ['lot'] }), token({ id: 'd', revoked_at: '2026-11-27T10:00:00Z' })];
  expect(warningsOf(last, [last, ...others], { name: 'bob' }, kNow).join()).toMatch(/last admin/);
  expect(warningsOf(last, [last, token({ id: 'e' })], { name: 'bob' }, kNow)).toEqual([]);
  expect(warningsOf(token({ role: 'viewer' }), [], { name: 'anne' }, kNow).join()).toMatch(/signed out/);
});

test('names of sites come by commas or blanks', () => {
  expect(namesIn(' lot, garage  deck-2,')).toEqual(['lot', 'garage', 'deck-2']);
});
