import { expect, test } from 'vitest';

import { sessionsAsked, versionsAsked } from './wanted';

const version = (number: number, isDeleted = false) => ({ version: number, files_deleted_at: isDeleted ? '2026-01-01T00:00:00Z' : null });

test('the last two versions that have files, unless the address says others', () => {
  const versions = [version(4), version(3, true), version(2), version(1)];
  expect(versionsAsked(versions, null, null)).toEqual({ from: 2, to: 4 });
  expect(versionsAsked(versions, '1', null)).toEqual({ from: 1, to: 4 });
  expect(versionsAsked(versions, '4', null)).toEqual({ from: 4, to: 2 });
  expect(versionsAsked(versions, null, '2')).toEqual({ from: 1, to: 2 });
  expect(versionsAsked(versions, '2', 'latest')).toEqual({ from: 2, to: 4 });
  expect(versionsAsked(versions, '3', '4')).toEqual({ from: 3, to: 4 }); // the service says why not
});

test('one version is nothing to compare', () => {
  expect(versionsAsked([version(1)], null, null)).toBeNull();
  expect(versionsAsked([version(2), version(1, true)], null, null)).toBeNull();
  expect(versionsAsked([version(2), version(1)], '2', '2')).toBeNull();
  expect(versionsAsked([], null, null)).toBeNull();
});

test('two drives of a version', () => {
  expect(sessionsAsked(['a', 'b', 'c'], null, null)).toEqual({ from: 'a', to: 'c' });
  expect(sessionsAsked(['a', 'b', 'c'], 'c', 'gone')).toEqual({ from: 'c', to: 'b' });
  expect(sessionsAsked(['a'], null, null)).toBeNull();
});
