// Everything that a comparison of two versions is shown with.

import type { Matrix4 } from 'three';

import { addressOf, fetchJson, request } from '../api/client';
import { fetchCollection, fetchMap, type Collection, type SlotProperties } from '../api/map_files';
import type { Comparison, MapVersion } from '../api/types';
import { siteFromGeoJson } from '../scene/geo';
import { laterFromEarlier } from './alignment';
import { changesOf, type Change, type RegionProperties } from './changes';

export interface LoadedComparison {
  comparison: Comparison;
  earlier: MapVersion;
  later: MapVersion;
  laterFromEarlier: Matrix4;
  changes: Change[];
}

export async function loadComparison(site: string, from: string, to: string): Promise<LoadedComparison> {
  const path = { site };
  const query = { from, to };
  const [comparison, regions, earlier, later] = await Promise.all([
    request('get', '/api/v1/sites/{site}/compare', { path, query }) as Promise<Comparison>,
    fetchJson(addressOf('get', '/api/v1/sites/{site}/compare', { path, query: { ...query, format: 'geojson' } })) as Promise<Collection<RegionProperties>>,
    fetchMap(site, from),
    fetchMap(site, to),
  ]);
  const [earlierSlots, laterSlots] = await Promise.all([earlier, later].map((map) => fetchCollection<SlotProperties>(map, 'slots.geojson')));
  const matrix = laterFromEarlier(comparison.alignment);
  const changes = changesOf({
    comparison, regions, toSite: siteFromGeoJson(later.datum),
    slots: { earlier: earlierSlots!, later: laterSlots! }, laterFromEarlier: matrix,
  });
  return { comparison, earlier, later, laterFromEarlier: matrix, changes };
}
