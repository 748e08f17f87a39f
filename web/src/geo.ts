// From WGS84 to the site, as GeographicLib's LocalCartesian has it: GeoJSON of a map that is on Earth is in degrees.

import type { Vector } from './api';
import type { Schemas } from './api_client';

const kRadius = 6378137; // [m]
const kFlattening = 1 / 298.257223563;
const kEccentricity = kFlattening * (2 - kFlattening); // squared

const radians = (degrees: number) => (degrees * Math.PI) / 180;

/** Earth-centered, [m]. */
function earthFromGeodetic(longitude: number, latitude: number, height: number): Vector {
  const [sin, cos] = [Math.sin(radians(latitude)), Math.cos(radians(latitude))];
  const normal = kRadius / Math.sqrt(1 - kEccentricity * sin * sin);
  const across = (normal + height) * cos;
  return [
    across * Math.cos(radians(longitude)),
    across * Math.sin(radians(longitude)),
    (normal * (1 - kEccentricity) + height) * sin,
  ];
}

/** Turns positions of a map's GeoJSON into points of its site; without a datum they are that already. */
export function siteFromGeoJson(datum: Schemas['Map']['datum']): (position: number[]) => Vector {
  if (!datum) return ([x, y, z]) => [x!, y!, z ?? 0];
  const { latitude_deg: latitude, longitude_deg: longitude, altitude } = datum;
  const origin = earthFromGeodetic(longitude, latitude, altitude);
  const [sinLat, cosLat] = [Math.sin(radians(latitude)), Math.cos(radians(latitude))];
  const [sinLon, cosLon] = [Math.sin(radians(longitude)), Math.cos(radians(longitude))];
  return ([lon, lat, height]) => {
    const point = earthFromGeodetic(lon!, lat!, height ?? altitude);
    const [x, y, z] = point.map((value, axis) => value - origin[axis]!) as Vector;
    return [
      -sinLon * x + cosLon * y,
      -sinLat * cosLon * x - sinLat * sinLon * y + cosLat * z,
      cosLat * cosLon * x + cosLat * sinLon * y + sinLat * z,
    ];
  };
}
