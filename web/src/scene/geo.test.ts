import { expect, test } from 'vitest';

import { geoJsonFromSite, siteFromGeoJson } from './geo';

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

test('points go to Earth and come back', () => {
  const datum = { latitude_deg: 48.137, longitude_deg: 11.576, altitude: 519.3, is_altitude_known: true };
  const [there, back] = [geoJsonFromSite(datum), siteFromGeoJson(datum)];
  for (const point of [[0, 0, 0], [812.5, -431.25, 12.125], [-3000, 5000, -20]] as [number, number, number][])
    back(there(point)).forEach((value, axis) => expect(value).toBeCloseTo(point[axis]!, 6));
  expect(geoJsonFromSite(null)([1, 2, 3])).toEqual([1, 2, 3]);
});
