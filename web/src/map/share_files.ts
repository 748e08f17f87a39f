// The files of a map version, grouped and explained for those who take them elsewhere.

import type { Schemas } from '../api/client';

export type MapFile = Schemas['MapFile'];

export interface Download {
  file: MapFile;
  about: string;
}

export interface FileGroup {
  title: string;
  about: string;
  downloads: Download[];
}

export interface Downloads {
  groups: FileGroup[];
  /** What programs read part by part, and steps in between: nothing to begin with. */
  internal: MapFile[];
}

const kOfMap: { title: string; about: string; files: Record<string, string> }[] = [
  {
    title: 'Ground',
    about: 'In the frame of the site: meters, z up. GeoJSON and orthophoto lie on Earth where the map is georeferenced.',
    files: {
      'map.glb': 'the textured mesh for viewers: glTF, Draco-compressed',
      'map_plain.glb': 'the same without Draco, for programs that cannot read it',
      'ground.ply': 'the mesh with the sigma of each vertex, for surveyors: CloudCompare, MeshLab',
      'tileset.json': 'the entry of the 3D Tiles, for Cesium and the like: the tiles lie beside it',
      'ortho.png': 'the picture from above',
      'ortho.pgw': 'where that picture lies: its world file',
      'ortho.tif': 'the picture from above as a GeoTIFF, for QGIS and ArcGIS',
    },
  },
  {
    title: 'Parking',
    about: 'GeoJSON, by deck.',
    files: {
      'slots.geojson': 'parking slots with kind, size and state, by drive',
      'free_space.geojson': 'outlines of the ground that was seen to be drivable',
      'markings.geojson': 'lines, areas, kerbs and bumps on the ground',
      'surfaces.geojson': 'what lies beside the ground: pavement, grass, walls',
    },
  },
  { title: 'Report', about: 'How the map came to be.', files: { 'report.json': 'residuals, coverage, loops, warnings and times of each stage' } },
];

const kOfDrive: Record<string, string> = {
  'trajectory.tum': 'poses of the car in the site: TUM, read by evo',
  'trajectory.geojson': 'the same as a line on the map',
  'trajectory.kml': 'the same for Google Earth',
  'covariance.csv': 'the covariance of each pose',
  'odometry.tum': 'poses before loops, GNSS and other drives: it drifts',
  'calibration.yaml': 'cameras and their mounting, as refined',
  'keyframes.json': 'times and poses of the pictures that were used',
  'gnss.json': 'where GNSS fixes lie, which were used, and how far they are off',
  'diagnostics.json': 'what the plots show: inliers, residuals, sigmas over time',
};

const isInternal = (name: string) => name.endsWith('.bin') || name.startsWith('tiles/') || /^[^/]+\/[^/]+\//.test(name);

/** Everything that a version has: no file is left out, be it unknown to this page. */
export function groupFiles(files: readonly MapFile[], drives: readonly string[]): Downloads {
  const left = new Map(files.map((file) => [file.name, file]));
  const take = (folder: string, known: Record<string, string>) =>
    Object.entries(known).flatMap(([name, about]) => {
      const file = left.get(folder + name);
      left.delete(folder + name);
      return file ? [{ file, about }] : [];
    });

  const groups: FileGroup[] = kOfMap.map(({ title, about, files: known }) => ({ title, about, downloads: take('', known) }));
  for (const drive of drives)
    groups.push({ title: `Drive ${drive}`, about: 'Stamps are those of the log.', downloads: take(`${drive}/`, kOfDrive) });
  const rest = [...left.values()];
  groups.push({
    title: 'More',
    about: '',
    downloads: rest.filter(({ name }) => !isInternal(name)).map((file) => ({ file, about: file.content_type })),
  });
  return { groups: groups.filter(({ downloads }) => downloads.length > 0), internal: rest.filter(({ name }) => isInternal(name)) };
}

export const sizeOf = (files: readonly MapFile[]) => files.reduce((sum, { bytes }) => sum + bytes, 0);

/** What a file is called where it is saved: it says which map it is of. */
export const savedAs = (site: string, version: number, name: string) => `${site}-${version}-${name.replaceAll('/', '-')}`;

/** Checksums by the names under which the files are saved here: for `sha256sum --check`. */
export const checksumsOf = (site: string, version: number, files: readonly MapFile[]) =>
  files.map(({ name, sha256 }) => `${sha256}  ${savedAs(site, version, name)}\n`).join('');
