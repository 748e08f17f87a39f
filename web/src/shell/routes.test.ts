import { expect, test } from 'vitest';

import { pathOf, pathOfOldAddress, routeOf, type Route } from './routes';

test('every place has a path that leads back to it', () => {
  const places: Route[] = [
    { name: 'sites' },
    { name: 'site', site: 'Tiefgarage Süd / 2' },
    { name: 'map', site: 'lot', version: '12' },
    { name: 'map', site: 'maps', version: 'latest' },
    { name: 'compare', site: 'lot' },
    { name: 'drives' },
    { name: 'drive', drive: '271e4d468e22b3b6' },
    { name: 'upload' },
    { name: 'rigs' },
    { name: 'rig', rig: 'car' },
    { name: 'jobs' },
    { name: 'job', job: 'd980c00b6027f6f5' },
    { name: 'review' },
    { name: 'settings', section: 'webhooks' },
  ];
  for (const place of places) expect(routeOf(pathOf(place))).toEqual(place);
});

test('what leads nowhere says so', () => {
  for (const path of ['/nowhere', '/sites/lot/maps', '/sites/lot/maps/1/2', '/upload/now'])
    expect(routeOf(path)).toEqual({ name: 'unknown', path });
  expect(routeOf('/sites/%')).toEqual({ name: 'site', site: '%' });
});

test('addresses of before still lead to their map', () => {
  expect(pathOfOldAddress('/', new URLSearchParams('site=lot'))).toBe('/sites/lot/maps/latest');
  expect(pathOfOldAddress('/', new URLSearchParams('site=lot&version=3'))).toBe('/sites/lot/maps/3');
  expect(pathOfOldAddress('/', new URLSearchParams())).toBeNull();
  expect(pathOfOldAddress('/drives', new URLSearchParams('site=lot'))).toBeNull();
});
