// Between WGS84 and the site, as GeographicLib's LocalCartesian has it: GeoJSON of a map that is on Earth is in degrees.

import type { Vector } from '../api/types';
import type { Schemas } from '../api/client';

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

type Datum = Schemas['Map']['datum'];

/** Rows: east, north and up at a datum, Earth-centered. */
function axesAt({ latitude_deg: latitude, longitude_deg: longitude }: NonNullable<Datum>): [Vector, Vector, Vector] {
  const [sinLat, cosLat] = [Math.sin(radians(latitude)), Math.cos(radians(latitude))];
  const [sinLon, cosLon] = [Math.sin(radians(longitude)), Math.cos(radians(longitude))];
  return [
    [-sinLon, cosLon, 0],
    [-sinLat * cosLon, -sinLat * sinLon, cosLat],
    [cosLat * cosLon, cosLat * sinLon, sinLat],
  ];
}

/** Turns positions of a map's GeoJSON into points of its site; without a datum they are that already. */
export function siteFromGeoJson(datum: Datum): (position: number[]) => Vector {
  if (!datum) return ([x, y, z]) => [x!, y!, z ?? 0];
  const { latitude_deg: latitude, longitude_deg: longitude, altitude } = datum;
  const origin = earthFromGeodetic(longitude, latitude, altitude);
  const axes = axesAt(datum);
  return ([lon, lat, height]) => {
    const point = earthFromGeodetic(lon!, lat!, height ?? altitude);
    const [x, y, z] = point.map((value, axis) => value - origin[axis]!) as Vector;
    return axes.map((axis) => axis[0] * x + axis[1] * y + axis[2] * z) as Vector;
  };
}

/** Turns points of a site into positions of its map's GeoJSON: [longitude, latitude, height]. */
export function geoJsonFromSite(datum: Datum): (point: Vector) => [number, number, number] {
  if (!datum) return (point) => point;
  const { latitude_deg: latitude, longitude_deg: longitude, altitude } = datum;
  const origin = earthFromGeodetic(longitude, latitude, altitude);
  const axes = axesAt(datum);
  return (point) => {
    const earth = origin.map(
      (value, k) => value + axes[0][k]! * point[0] + axes[1][k]! * point[1] + axes[2][k]! * point[2],
    ) as Vector;
    return geodeticFromEarth(earth);
  };
}

const kRounds = 4; // each leaves less than a hundredth of the error of the one before

function geodeticFromEarth([x, y, z]: Vector): [number, number, number] {
  const across = Math.hypot(x, y);
  let latitude = Math.atan2(z, across * (1 - kEccentricity));
  let height = 0;
  for (let round = 0; round < kRounds; ++round) {
    const sin = Math.sin(latitude);
    const normal = kRadius / Math.sqrt(1 - kEccentricity * sin * sin);
    height = across * Math.cos(latitude) + z * sin - kRadius * Math.sqrt(1 - kEccentricity * sin * sin);
    latitude = Math.atan2(z, across * (1 - (kEccentricity * normal) / (normal + height)));
  }
  return [(Math.atan2(y, x) * 180) / Math.PI, (latitude * 180) / Math.PI, height];
}
