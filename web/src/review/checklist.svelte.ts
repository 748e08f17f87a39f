// The checklist of a version: the items of its site, and who ticked what. Ticks of others come by themselves.

import { request, type Schemas } from '../api/client';
import type { MapVersion } from '../api/types';
import { Live } from '../ui/live.svelte';
import type { ChecklistEntry } from './checklist';

export class ChecklistState {
  readonly list: Live<Schemas['Checklist']>;
  error = $state('');
  /** What was clicked, until the service has said so. */
  private asked: ReadonlyMap<string, boolean> = $state.raw(new Map());

  /** To be made while a component is. */
  constructor(private readonly map: MapVersion) {
    this.list = new Live(() => request('get', '/api/v1/sites/{site}/maps/{version}/checklist', { path: this.version }), ['review', 'map']);
  }

  get entries(): readonly ChecklistEntry[] {
    return this.list.value?.items ?? [];
  }

  isTicked({ id, ticked_by: by }: ChecklistEntry): boolean {
    return this.asked.get(id) ?? by !== null;
  }

  async tick(id: string, ticked: boolean): Promise<void> {
    this.asked = new Map(this.asked).set(id, ticked);
    this.error = '';
    try {
      await request('put', '/api/v1/sites/{site}/maps/{version}/checklist/{item}', { path: { ...this.version, item: id }, body: { ticked } });
      await this.list.refresh();
    } catch (reason) {
      this.error = `The tick was not kept: ${reason instanceof Error ? reason.message : String(reason)}.`;
    }
    const rest = new Map(this.asked);
    rest.delete(id);
    this.asked = rest;
  }

  /** Gives the site its own items; null: the usual ones again. */
  async setItems(items: { id?: string; text: string }[] | null): Promise<void> {
    await request('put', '/api/v1/sites/{site}', { path: { site: this.map.site }, body: { review_checklist: items } });
    await this.list.refresh();
  }

  private get version() {
    return { site: this.map.site, version: String(this.map.version) };
  }
}
