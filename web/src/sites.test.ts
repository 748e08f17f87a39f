import { describe, expect, test } from 'vitest';

import type { Drive } from './api';
import { firstSite, hasMap, sitesWithoutDrives } from './sites';

const site = (name: string, latest_version: number | null) => ({ name, latest_version });
const drive = (site: string, state: Drive['state']) => ({ site, state });

describe('hasMap', () => {
  test('goes by versions', () => {
    const sites = [site('new', null), site('lot', 3)];

    expect(hasMap('lot', sites)).toBe(true);
    expect(hasMap('new', sites)).toBe(false);
    expect(hasMap('elsewhere', sites)).toBe(false);
    expect(hasMap(null, sites)).toBe(false);
  });
});

describe('firstSite', () => {
  test('is that of the newest drive with a map, whatever the drive does now', () => {
    const sites = [site('new', null), site('lot', 3), site('old', 1)];

    expect(firstSite([drive('new', 'queued'), drive('lot', 'processing'), drive('old', 'ready')], sites)).toBe('lot');
  });

  test('may have no drives left', () => {
    expect(firstSite([drive('new', 'queued')], [site('new', null), site('lot', 3)])).toBe('lot');
    expect(firstSite([], [])).toBeNull();
  });
});

describe('sitesWithoutDrives', () => {
  test('are those with versions only', () => {
    const sites = [site('new', null), site('lot', 3), site('gone', 2)];

    expect(sitesWithoutDrives([drive('lot', 'ready')], sites).map(({ name }) => name)).toEqual(['gone']);
  });
});
