// The checklist of a version: the site's items, or the usual ones, and what is ticked. The service has no place for
// ticks before there is a decision: this browser keeps them.

import { request } from '../api/client';
import type { MapVersion, Site } from '../api/types';
import { Live } from '../ui/live.svelte';
import { itemsIn, kUsual, noteWith, wordsOfTicks } from './checklist';

export class ChecklistState {
  readonly site: Live<Site>;
  private ticked: ReadonlySet<string> = $state.raw(new Set());
  private readonly key: string;

  readonly own: string[] | null = $derived.by(() => itemsIn(this.site.value?.note ?? ''));
  readonly items: readonly string[] = $derived(this.own ?? Object.values(kUsual));
  readonly numTicked: number = $derived(this.items.filter((item) => this.ticked.has(item)).length);

  /** To be made while a component is. */
  constructor(private readonly map: MapVersion) {
    this.site = new Live(() => request('get', '/api/v1/sites/{site}', { path: { site: map.site } }), ['review', 'map']);
    this.key = `parkade.checklist.${map.site}/${map.version}`;
    this.ticked = new Set(stored(this.key));
  }

  isTicked(item: string): boolean {
    return this.ticked.has(item);
  }

  tick(item: string, isTicked: boolean): void {
    const ticked = new Set(this.ticked);
    if (isTicked) ticked.add(item);
    else ticked.delete(item);
    this.ticked = ticked;
    localStorage.setItem(this.key, JSON.stringify([...ticked]));
  }

  get words(): string {
    return wordsOfTicks(this.items, (item) => this.ticked.has(item));
  }

  /** Gives the site its own items; none: the usual ones again. */
  async setItems(items: string[]): Promise<void> {
    const path = { site: this.map.site };
    const { note } = await request('get', '/api/v1/sites/{site}', { path }); // as it is by now
    await request('put', '/api/v1/sites/{site}', { path, body: { note: noteWith(note, items) } });
    await this.site.refresh();
  }
}

function stored(key: string): string[] {
  try {
    const items: unknown = JSON.parse(localStorage.getItem(key) ?? '[]');
    return Array.isArray(items) ? items.filter((item) => typeof item === 'string') : [];
  } catch {
    return []; // another page wrote it
  }
}
