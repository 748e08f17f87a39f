// Where the page is, by the browser's address, and how it goes elsewhere.

import { pathOfOldAddress, routeOf, type Route } from './routes';

class Navigation {
  route: Route = $state({ name: 'sites' });
  query: URLSearchParams = $state.raw(new URLSearchParams());

  constructor() {
    const old = pathOfOldAddress(location.pathname, new URLSearchParams(location.search));
    if (old) history.replaceState(null, '', old + location.hash);
    this.read();
    addEventListener('popstate', () => this.read());
  }

  /** Goes to a path, with a query where that is said; the browser's back button comes back. */
  go(path: string): void {
    history.pushState(null, '', path);
    this.read();
    scrollTo(0, 0);
  }

  /** Changes parameters of this address, which is the same place still; null removes one. */
  setQuery(changes: Record<string, string | null>): void {
    const query = new URLSearchParams(location.search);
    for (const [name, value] of Object.entries(changes))
      if (value === null) query.delete(name);
      else query.set(name, value);
    const text = query.toString();
    history.replaceState(null, '', location.pathname + (text === '' ? '' : `?${text}`) + location.hash);
    this.query = query;
  }

  private read(): void {
    this.route = routeOf(location.pathname);
    this.query = new URLSearchParams(location.search);
  }
}

export const navigation = new Navigation();

/** Follows plain clicks on links of the page without loading it again. */
export function followLinks(event: MouseEvent): void {
  if (event.defaultPrevented || event.button !== 0 || event.metaKey || event.ctrlKey || event.shiftKey || event.altKey) return;
  const link = (event.target as Element | null)?.closest('a');
  if (!link || link.target !== '' || link.hasAttribute('download') || link.origin !== location.origin) return;
  if (link.pathname.startsWith('/api/') || /\.\w+$/.test(link.pathname)) return; // files of the service
  event.preventDefault();
  navigation.go(link.pathname + link.search + link.hash);
}
