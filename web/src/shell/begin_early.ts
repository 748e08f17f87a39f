// What the first page will need is asked for before anything is shown, all at once.

import { addressOf } from '../api/client';
import { askEarly } from '../api/early';
import { shareIn } from '../api/session';
import { loadPage } from './pages';
import type { Route } from './routes';

interface Tileset {
  root?: { content?: { uri?: string } };
}

export function beginEarly(route: Route): void {
  void loadPage(route)?.catch(() => undefined); // the page says so when it wants it
  if (route.name === 'map' && !shareIn(location.hash)) void askForMap(route.site, route.version).catch(() => undefined);
}

/** A map's first picture: its description, its report, its tree of tiles, and the tile of the whole. */
async function askForMap(site: string, wanted: string): Promise<void> {
  const map = await askEarly(addressOf('get', '/api/v1/sites/{site}/maps/{version}', { path: { site, version: wanted } }));
  if (!map.ok) return;
  const { version } = (await map.json()) as { version: number };
  const addressOfFile = (file: string) =>
    addressOf('get', '/api/v1/sites/{site}/maps/{version}/{file}', { path: { site, version: String(version), file } });
  void askEarly(addressOfFile('report.json')).catch(() => undefined);
  const tileset = (await (await askEarly(addressOfFile('tileset.json'))).json()) as Tileset;
  const first = tileset.root?.content?.uri;
  if (first) await askEarly(addressOfFile(first));
}
