import { expect, test } from 'vitest';

import { deedOf, detailOf, hasWords, placeOf, type AuditEntry } from './audit_words';

const entry: AuditEntry = {
  number: 3,
  at: '2026-11-27T18:49:12.019Z',
  caller: { id: null, name: 'anne' },
  address: '127.0.0.1',
  action: 'map.review',
  subject: 'lot/2',
  detail: { to: 'approved', comment: '', loops: ['a', 1] },
  sha256: '00',
};

test('deeds are told in words, unknown ones as the service has them', () => {
  expect(deedOf(entry)).toBe('judged a map');
  expect(deedOf({ action: 'moon.land' })).toBe('moon.land');
});

test('details leave out what is empty', () => {
  expect(detailOf(entry)).toBe('to: approved, loops: ["a",1]');
  expect(detailOf({ detail: { sha256: 'fb671b18ad69'.padEnd(64, '0') } })).toBe('sha256: fb671b18ad69…');
  expect(detailOf({ detail: null })).toBe('');
});

test('details are said as the rest of the page says them', () => {
  expect(detailOf({ detail: { to: 'in_review' } })).toBe('to: in review');
  expect(detailOf({ detail: { expires_at: '2026-12-07T07:27:46.992Z' } })).toMatch(/^expires at: 2026-12-0[678] \d\d:27$/);
});

test('what an entry tells of is linked where it has a place', () => {
  expect(placeOf(entry)).toBe('/sites/lot/maps/2');
  expect(placeOf({ action: 'drive.create', subject: '27f' })).toBe('/drives/27f');
  expect(placeOf({ action: 'drive.delete', subject: '27f' })).toBeNull();
  expect(placeOf({ action: 'token.create', subject: '27f' })).toBeNull();
});

test('a filter wants all its words, in any case', () => {
  expect(hasWords(entry, 'Anne lot/2')).toBe(true);
  expect(hasWords(entry, 'judged approved')).toBe(true);
  expect(hasWords(entry, 'anne garage')).toBe(false);
  expect(hasWords(entry, '')).toBe(true);
});
