import { expect, test } from 'vitest';

import { basemapIn, faultOf } from './basemap';

test('a configuration may name tiles, an archive, or nothing', () => {
  expect(basemapIn({ basemap: { tiles: 'https://t.example/{z}/{x}/{y}.png', attribution: '© T' } })).toEqual({
    kind: 'tiles', url: 'https://t.example/{z}/{x}/{y}.png', attribution: '© T',
  });
  expect(basemapIn({ basemap: { pmtiles: '/basemap.pmtiles' } })).toEqual({ kind: 'pmtiles', url: '/basemap.pmtiles', attribution: '' });
  for (const none of [{}, { basemap: null }, null]) expect(basemapIn(none)).toBeNull();
});

test('what is wrong in it is said', () => {
  expect(() => basemapIn({ basemap: { tiles: 'https://t.example/' } })).toThrow('{z}');
  expect(() => basemapIn({ basemap: {} })).toThrow('neither');
  expect(() => basemapIn({ basemap: 'https://t.example' })).toThrow('must be an object');
});

test('why no tile comes is said in words', () => {
  expect(faultOf({ status: 401 })).toBe('its server answers 401');
  expect(faultOf({ status: 0 })).toMatch(/does not answer.*CORS/);
  expect(faultOf({})).toBe('what its server sends is no tile');
});
