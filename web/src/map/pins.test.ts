import { describe, expect, test } from 'vitest';

import type { ReportPin } from '../api/map_files';
import {
  formatPlace,
  formatResidual,
  obstacleOf,
  parsePlace,
  parsePoint,
  pinsForRequest,
  pinsOfReport,
  rmsOfPins,
} from './pins';

function reportPin(change: Partial<ReportPin> = {}): ReportPin {
  return {
    point: [1, 2, 0.5],
    latitude_deg: 48.1,
    longitude_deg: 11.5,
    height: 519,
    is_used: true,
    residual: [0.03, -0.04, 0.12],
    ...change,
  };
}

describe('parsePlace', () => {
  test('takes what people copy from a map', () => {
    expect(parsePlace('48.137154, 11.576124')).toEqual({ latitude: 48.137154, longitude: 11.576124, height: null });
    expect(parsePlace(' -33.9;18.4;  12.5 ')).toEqual({ latitude: -33.9, longitude: 18.4, height: 12.5 });
    expect(parsePlace('48.1° 11.5°')).toEqual({ latitude: 48.1, longitude: 11.5, height: null });
  });
  test('says what is wrong', () => {
    for (const text of ['', '48.1', '48.1, east', '1 2 3 4']) expect(parsePlace(text)).toMatch(/^Latitude, longitude/);
    expect(parsePlace('91, 11')).toMatch(/latitude/);
    expect(parsePlace('48, 181')).toMatch(/longitude/);
  });
});

test('points are three numbers', () => {
  expect(parsePoint('1.5, -2 0')).toEqual([1.5, -2, 0]);
  expect(parsePoint('1.5, -2')).toBeNull();
  expect(parsePoint('1, 2, up')).toBeNull();
});

test('residuals are across and up, and heights that nobody knows do not count', () => {
  const [known, unknown, unused] = pinsOfReport([
    reportPin(),
    reportPin({ height: null, residual: [0.06, 0.08, 9] }),
    reportPin({ is_used: false, residual: null }),
  ]);
  expect(formatResidual(known!)).toBe('off by 5.0 cm, 12.0 cm up');
  expect(formatResidual(unknown!)).toBe('off by 10.0 cm');
  expect(formatResidual({ ...known!, residual: [0, 0, -1e-5] })).toBe('off by 0.0 cm, 0.0 cm up');
  expect(formatResidual(unused!)).toMatch(/^not used/);
  expect(rmsOfPins([known!, unused!])).toBeCloseTo(0.13);
  expect(rmsOfPins([unused!])).toBeNull();
  expect(formatPlace(unknown!)).toBe('48.1000000, 11.5000000');
});

test('a version is built with none, or two or more that are not those it has', () => {
  const kept = pinsOfReport([reportPin(), reportPin({ point: [9, 9, 0] })]);
  expect(obstacleOf([], [])).toMatch(/^Two pins/);
  expect(obstacleOf(kept, kept)).toMatch(/^Nothing/);
  expect(obstacleOf(kept.slice(1), kept)).toMatch(/^One more/);
  expect(obstacleOf([], kept)).toBeNull();
  expect(obstacleOf([...kept, { ...kept[0]!, residual: null }], kept)).toBeNull();
});

test('requests leave out heights that nobody knows', () => {
  const pins = pinsOfReport([reportPin({ height: null }), reportPin()]);
  expect(pinsForRequest(pins)).toEqual([
    { point: [1, 2, 0.5], latitude: 48.1, longitude: 11.5 },
    { point: [1, 2, 0.5], latitude: 48.1, longitude: 11.5, height: 519 },
  ]);
});
