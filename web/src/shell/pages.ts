// The page of each place. It comes when it is first gone to: nobody waits for a scene to see a list.

import type { Component } from 'svelte';

import type { Route } from './routes';

export type Page = Component<{ route: never }>;

const kPages: Partial<Record<Route['name'], () => Promise<{ default: unknown }>>> = {
  sites: () => import('../sites/SitesPage.svelte'),
  site: () => import('../sites/SitePage.svelte'),
  map: () => import('../map/MapPage.svelte'),
  compare: () => import('../compare/ComparePage.svelte'),
  drives: () => import('../drives/DrivesPage.svelte'),
  drive: () => import('../drives/DrivePage.svelte'),
  upload: () => import('../upload/UploadPage.svelte'),
  rigs: () => import('../drives/RigsPage.svelte'),
  rig: () => import('../drives/RigPage.svelte'),
  jobs: () => import('../drives/JobsPage.svelte'),
  job: () => import('../drives/JobPage.svelte'),
  review: () => import('../review/ReviewPage.svelte'),
  settings: () => import('../settings/SettingsPage.svelte'),
};

/** Undefined where nothing is at this place. */
export const loadPage = (route: Route): Promise<Page> | undefined => kPages[route.name]?.().then((loaded) => loaded.default as Page);
