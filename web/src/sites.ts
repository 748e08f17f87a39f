import type { Drive, Site } from './api';

type Mapped = Pick<Site, 'name' | 'latest_version'>;
type Driven = Pick<Drive, 'site'>;

/** A site has something to show once it has a version, whatever its drives do now and whether there are any left. */
export function hasMap(name: string | null, sites: Mapped[]): boolean {
  return sites.some((site) => site.name === name && site.latest_version !== null);
}

/** What the page opens with: the site of the newest drive that has a map, or else the newest site with one. */
export function firstSite(drives: Driven[], sites: Mapped[]): string | null {
  const mapped = [...drives.map((drive) => drive.site), ...sites.map((site) => site.name)];
  return mapped.find((name) => hasMap(name, sites)) ?? null;
}

/** Sites whose versions stayed when their drives were deleted. */
export function sitesWithoutDrives(drives: Driven[], sites: Mapped[]): Mapped[] {
  return sites.filter((site) => site.latest_version !== null && !drives.some((drive) => drive.site === site.name));
}
