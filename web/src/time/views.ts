// The pictures that show a spot of the map, of all its drives.

import { request, type Schemas } from '../api/client';
import type { Vector } from '../api/types';
import type { Workspace } from '../map/workspace.svelte';

export interface View {
  drive: string;
  driveName: string;
  camera: string;
  time: string; // on the drive's clock
  pixel: [number, number];
  distance: number; // [m]
  resolution: number; // [px/m]
  url: string;
}

export interface Views {
  views: View[];
  /** Why a drive says nothing, by its name. */
  complaints: { drive: string; reason: string }[];
}

const kOfDrive = 12;

/** Best resolution first, whichever drive it is of. */
function merged(answers: { drive: { id: string; name: string }; views: Schemas['Views']['views'] }[]): View[] {
  return answers
    .flatMap(({ drive, views }) =>
      views.map(({ camera, time, pixel, distance, resolution, url }) => ({
        drive: drive.id,
        driveName: drive.name,
        camera,
        time,
        pixel,
        distance,
        resolution,
        url,
      })),
    )
    .sort((a, b) => b.resolution - a.resolution);
}

export async function fetchViews({ drives, map }: Pick<Workspace, 'drives' | 'map'>, point: Vector): Promise<Views> {
  const complaints: Views['complaints'] = [];
  const query = { point: point.map((value) => value.toFixed(3)).join(','), version: String(map.version), limit: kOfDrive };
  const answers = await Promise.all(
    drives.map(async (drive) => {
      try {
        const { views } = await request('get', '/api/v1/drives/{drive}/images', { path: { drive: drive.id }, query });
        return [{ drive, views }];
      } catch (error) {
        complaints.push({ drive: drive.name, reason: error instanceof Error ? error.message : String(error) });
        return [];
      }
    }),
  );
  return { views: merged(answers.flat()), complaints };
}

/** The address of a view's picture, no wider than that. */
export const pictureOfView = ({ url }: Pick<View, 'url'>, width: number): string => `${url}&width=${width}`;
