// Addresses of the page. Each place has one of its own, so that it can be linked, and reloaded.

export type Route =
  | { name: 'sites' }
  | { name: 'site'; site: string }
  | { name: 'map'; site: string; version: string }
  | { name: 'compare'; site: string }
  | { name: 'drives' }
  | { name: 'drive'; drive: string }
  | { name: 'upload' }
  | { name: 'rigs' }
  | { name: 'rig'; rig: string }
  | { name: 'jobs' }
  | { name: 'job'; job: string }
  | { name: 'review' }
  | { name: 'settings'; section: string }
  | { name: 'unknown'; path: string };

/** The place that a path leads to; versions are numbers, "latest" or "approved". */
export function routeOf(path: string): Route {
  const parts = path.split('/').filter((part) => part !== '').map(decoded);
  const [first, second, third, fourth] = parts;
  if (first === undefined) return { name: 'sites' };
  if (first === 'sites') {
    if (second === undefined) return { name: 'sites' };
    if (third === undefined) return { name: 'site', site: second };
    if (third === 'compare' && parts.length === 3) return { name: 'compare', site: second };
    if (third === 'maps' && fourth !== undefined && parts.length === 4)
      return { name: 'map', site: second, version: fourth };
  }
  if (first === 'drives') return second === undefined ? { name: 'drives' } : { name: 'drive', drive: second };
  if (first === 'jobs') return second === undefined ? { name: 'jobs' } : { name: 'job', job: second };
  if (first === 'rigs') return second === undefined ? { name: 'rigs' } : { name: 'rig', rig: second };
  if (first === 'upload' && parts.length === 1) return { name: 'upload' };
  if (first === 'review' && parts.length === 1) return { name: 'review' };
  if (first === 'settings' && parts.length <= 2) return { name: 'settings', section: second ?? 'access' };
  return { name: 'unknown', path };
}

/** The path of a place. */
export function pathOf(route: Route): string {
  const part = encodeURIComponent;
  switch (route.name) {
    case 'site': return `/sites/${part(route.site)}`;
    case 'map': return `/sites/${part(route.site)}/maps/${part(route.version)}`;
    case 'compare': return `/sites/${part(route.site)}/compare`;
    case 'drive': return `/drives/${part(route.drive)}`;
    case 'job': return `/jobs/${part(route.job)}`;
    case 'rig': return `/rigs/${part(route.rig)}`;
    case 'settings': return `/settings/${part(route.section)}`;
    case 'unknown': return route.path;
    default: return `/${route.name}`;
  }
}

/** Where an address of before leads: "/?site=lot" was the map of a site. */
export function pathOfOldAddress(path: string, query: URLSearchParams): string | null {
  const site = query.get('site');
  if (path !== '/' || site === null || site === '') return null;
  return pathOf({ name: 'map', site, version: query.get('version') ?? 'latest' });
}

function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part; // a lone "%"
  }
}
