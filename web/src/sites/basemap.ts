// What lies under the sites on the overview, as whoever runs the service configured it in /viewer.json; nothing by default.

export interface Basemap {
  kind: 'tiles' | 'pmtiles';
  url: string;
  attribution: string;
}

/** Throws with words for whoever wrote the configuration. */
export function basemapIn(configuration: unknown): Basemap | null {
  const basemap = isObject(configuration) ? configuration['basemap'] : undefined;
  if (basemap === undefined || basemap === null) return null;
  if (!isObject(basemap)) throw new Error('viewer.json: "basemap" must be an object with "tiles" or "pmtiles"');
  const attribution = typeof basemap['attribution'] === 'string' ? basemap['attribution'] : '';
  const { tiles, pmtiles } = basemap;
  if (typeof tiles === 'string') {
    if (!['{z}', '{x}', '{y}'].every((part) => tiles.includes(part)))
      throw new Error('viewer.json: "tiles" must be an address with {z}, {x} and {y} in it');
    return { kind: 'tiles', url: tiles, attribution };
  }
  if (typeof pmtiles === 'string') return { kind: 'pmtiles', url: pmtiles, attribution };
  throw new Error('viewer.json: "basemap" has neither "tiles" nor "pmtiles"');
}

/** Why tiles did not come, for whoever configured them; MapLibre's errors have the answer's status, 0 without one. */
export function faultOf(error: { status?: number }): string {
  if (error.status === undefined) return 'what its server sends is no tile';
  if (error.status === 0) return 'its server does not answer, or does not let other pages read its tiles (CORS)';
  return `its server answers ${error.status}`;
}

/** The words of an archive's own attribution, which is HTML. */
export const wordsOf = (html: unknown) =>
  typeof html === 'string' ? (new DOMParser().parseFromString(html, 'text/html').body.textContent ?? '').trim() : '';

/** Asks the service; null where it has no such file. */
export async function fetchBasemap(): Promise<Basemap | null> {
  const response = await fetch('/viewer.json');
  return response.ok ? basemapIn(await response.json()) : null;
}

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}
