import { expect, test } from 'vitest';

import type { Report, ReportDrive } from '../api/map_files';
import { georeferenceOf, joinsOf, stretchesOf, summaryOfStretches, warningOfStretches } from './info_words';

const drive = {
  name: 'day1', length: 36, duration: 14, num_keyframes: 126,
  streams: [{ role: 'wheels', begin: '1767229200.500000000' }, { role: 'imu', begin: '1767229200.001300000' }],
  odometry: { degraded: [{ begin: '1767229203.501300000', end: '1767229212.001300000', reason: 'dark' }] },
} as unknown as ReportDrive;

test('stretches count from the start of the drive', () => {
  const [stretch] = stretchesOf(drive);
  expect(stretch!.begin).toBeCloseTo(3.5, 6);
  expect(stretch!.end).toBeCloseTo(12, 6);
  expect(stretchesOf({ name: 'x', length: 0, duration: 0, num_keyframes: 0 })).toEqual([]);
});

test('stretches are summed up, and long ones are a warning', () => {
  const stretches = stretchesOf(drive);
  expect(summaryOfStretches(stretches, 14)).toBe('8.5 s of 14 s (61 %) less sure');
  expect(summaryOfStretches([], 14)).toBeNull();
  expect(warningOfStretches('day1', stretches, 14)).toBe('61 % of drive day1 are less sure than the rest: dark.');
  expect(warningOfStretches('day1', stretches, 1400)).toBeNull();
});

test('how well the place on Earth is known', () => {
  const report = { georeference: { source: 'gnss', heights: 'ellipsoidal', position_sigma: [0.02, 1.04, 0.5], yaw_sigma: 0.0175 } } as unknown as Report;
  const datum = { latitude_deg: 48, longitude_deg: 11, altitude: 500 };
  expect(georeferenceOf(report, datum)).toEqual([
    ['Placed', 'by GNSS'], ['Sigma across', '1.0 m'], ['Sigma of height', '50 cm'], ['Sigma of north', '1.00°'], ['Heights', 'above the ellipsoid (WGS84)'],
  ]);
  expect(georeferenceOf(report, null)[0]![1]).toContain('Pins or GNSS');
});

test('drives are linked, or the report says why not', () => {
  const report = { join: { pairs: [
    { a: 'a', b: 'b', num_accepted: 42, links: Array(54), rejected: '' },
    { a: 'a', b: 'c', num_accepted: 0, links: [], rejected: 'too few links' },
  ] } } as unknown as Report;
  expect(joinsOf(report)).toEqual([
    { text: 'a and b: 42 of 54 links accepted', isGood: true },
    { text: 'a and c are not linked: too few links', isGood: false },
  ]);
  expect(joinsOf({} as Report)).toEqual([]);
});
