// What a place is called in tabs of the browser, its history, and to those who hear the page.

import type { Route } from './routes';

const kSections: Record<string, string> = { access: 'Access tokens', shares: 'Share links', webhooks: 'Webhooks', audit: 'Audit log' };

export function titleOf(route: Route): string {
  return [...partsOf(route), 'Parkade'].join(' · ');
}

function partsOf(route: Route): string[] {
  switch (route.name) {
    case 'sites': return ['Sites'];
    case 'site': return [route.site];
    case 'map': return [`${route.site}, ${/^\d+$/.test(route.version) ? `version ${route.version}` : `${route.version} version`}`];
    case 'compare': return [`Compare versions of ${route.site}`];
    case 'drives': return ['Drives'];
    case 'drive': return ['A drive'];
    case 'upload': return ['Upload'];
    case 'rigs': return ['Rigs'];
    case 'rig': return [`Rig ${route.rig}`];
    case 'jobs': return ['Jobs'];
    case 'job': return ['A job'];
    case 'review': return ['Review'];
    case 'settings': return [kSections[route.section] ?? 'Settings', 'Settings'].filter((part, i, all) => all.indexOf(part) === i);
    case 'unknown': return ['Nothing here'];
  }
}
