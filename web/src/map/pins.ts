// Points of a map whose place on Earth is known. No page in here: what the panel shows and sends.

import type { ReportPin } from '../api/map_files';
import type { Vector } from '../api/types';
import type { Schemas } from '../api/client';

export interface Pin {
  point: Vector; // [m] in the site of the version that is shown
  latitude: number; // [degrees]
  longitude: number;
  height: number | null; // [m] above the ellipsoid; null: nobody knows
  residual: Vector | null; // [m] east, north, up, as the version's report has it
  isUsed: boolean;
}

export function pinsOfReport(pins: ReportPin[] | undefined): Pin[] {
  return (pins ?? []).map((pin) => ({
    point: pin.point,
    latitude: pin.latitude_deg,
    longitude: pin.longitude_deg,
    height: pin.height,
    residual: pin.residual,
    isUsed: pin.is_used,
  }));
}

/** "48.137154, 11.576124, 519.3", commas, semicolons or blanks between, height optional; a sentence where it is none. */
export function parsePlace(text: string): Pick<Pin, 'latitude' | 'longitude' | 'height'> | string {
  const parts = text.trim().split(/[\s,;]+/).filter((part) => part !== '');
  const numbers = parts.map((part) => Number(part.replace(/°$/, '')));
  if (parts.length < 2 || parts.length > 3 || numbers.some((number) => !Number.isFinite(number)))
    return 'Latitude, longitude and, where known, the height: 48.137154, 11.576124, 519.3';
  const [latitude, longitude, height] = numbers as [number, number, number?];
  if (Math.abs(latitude) > 90) return 'A latitude lies between -90 and 90 degrees';
  if (Math.abs(longitude) > 180) return 'A longitude lies between -180 and 180 degrees';
  return { latitude, longitude, height: height ?? null };
}

/** "12.30, -4.05, 0.10" in meters; null where it is none. */
export function parsePoint(text: string): Vector | null {
  const numbers = text.trim().split(/[\s,;]+/).filter((part) => part !== '').map(Number);
  return numbers.length === 3 && numbers.every(Number.isFinite) ? (numbers as Vector) : null;
}

export const formatPoint = (point: Vector) => point.map((value) => value.toFixed(2)).join(', ');

/** Seven digits of a degree are a centimeter. */
export function formatPlace(pin: Pick<Pin, 'latitude' | 'longitude' | 'height'>): string {
  const height = pin.height === null ? '' : `, ${pin.height.toFixed(2)} m`;
  return `${pin.latitude.toFixed(7)}, ${pin.longitude.toFixed(7)}${height}`;
}

/** How far the map lies off a pin: [m] across and, where its height is known, up. */
function missOf(pin: Pin): { across: number; up: number } | null {
  if (!pin.residual) return null;
  const [east, north, up] = pin.residual;
  return { across: Math.hypot(east, north), up: pin.height === null ? 0 : up };
}

export function formatResidual(pin: Pin): string {
  if (!pin.isUsed) return 'not used: no drive of this version passes it';
  const miss = missOf(pin);
  if (!miss) return 'new';
  const centimeters = (meters: number) => `${(Math.round(1000 * meters) / 10 || 0).toFixed(1)} cm`; // and no -0.0
  return `off by ${centimeters(miss.across)}` + (pin.height === null ? '' : `, ${centimeters(miss.up)} up`);
}

/** [m] over the pins that the version was fitted to; null where there are none. */
export function rmsOfPins(pins: Pin[]): number | null {
  const misses = pins.map(missOf).filter((miss) => miss !== null);
  if (misses.length === 0) return null;
  return Math.sqrt(misses.reduce((sum, { across, up }) => sum + across * across + up * up, 0) / misses.length);
}

/** What keeps these pins from being built with; null: nothing. */
export function obstacleOf(pins: Pin[], kept: Pin[]): string | null {
  const isSame = pins.length === kept.length && pins.every((pin) => kept.includes(pin));
  if (isSame) return pins.length === 0 ? 'Two pins or more say where the map lies' : 'Nothing has changed yet';
  if (pins.length === 1) return 'One more pin: one alone does not say which way the map is turned';
  return null;
}

/** As POST /sites/NAME/maps takes them. */
export function pinsForRequest(pins: Pin[]): Schemas['WantedPin'][] {
  return pins.map(({ point, latitude, longitude, height }) => ({
    point,
    latitude,
    longitude,
    ...(height === null ? {} : { height }),
  }));
}
