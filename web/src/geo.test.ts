import { expect, test } from 'vitest';

import { siteFromGeoJson } from './geo';

test('positions without a datum are points of the site', () => {
  expect(siteFromGeoJson(null)([3, 4, 5])).toEqual([3, 4, 5]);
});

test('the datum is the origin, east is x, north is y', () => {
  const datum = { latitude_deg: 48.1, longitude_deg: 11.5, altitude: 500, is_altitude_known: true };
  const toSite = siteFromGeoJson(datum);
  for (const value of toSite([11.5, 48.1, 500])) expect(value).toBeCloseTo(0, 6);
  // By GeographicLib 2.1's LocalCartesian.
  const [east, north, up] = toSite([11.5013, 48.1009, 503]);
  expect(east).toBeCloseTo(96.83126, 4);
  expect(north).toBeCloseTo(100.08177, 4);
  expect(up).toBeCloseTo(2.99848, 4);
});
