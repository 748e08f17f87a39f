// Addresses to hand on: of exactly what is shown, and of what a share link shows.

import type { CameraView } from '../scene/map_scene';
import { pathOf } from '../shell/routes';
import { textOfView } from './view_text';

interface Shown {
  site: string;
  version: number;
  query: URLSearchParams;
  view: CameraView | null;
}

/** This version, seen as now. "latest" in it would be another map tomorrow. */
export function viewAddress(origin: string, { site, version, query, view }: Shown): string {
  const all = new URLSearchParams(query);
  if (view) all.set('view', textOfView(view));
  const text = all.toString().replaceAll('%2C', ',');
  return `${origin}${pathOf({ name: 'map', site, version: String(version) })}${text === '' ? '' : `?${text}`}`;
}

/** Parameters that lead where a link does not: to panels and times of drives. */
const kOfDrives = ['tab', 'drive', 't'];

/** A share link's address: of one version as it is seen now, or of the site. */
export function shareAddress(origin: string, secret: string, { site, version, query, view }: Shown, isOfVersion: boolean): string {
  if (!isOfVersion) return `${origin}${pathOf({ name: 'site', site })}#share=${secret}`;
  const seen = new URLSearchParams(query);
  for (const name of kOfDrives) seen.delete(name);
  if (!/^(slot|point):/.test(seen.get('chosen') ?? '')) seen.delete('chosen'); // comments, loops and measurements are for tokens
  return `${viewAddress(origin, { site, version, query: seen, view })}#share=${secret}`;
}
