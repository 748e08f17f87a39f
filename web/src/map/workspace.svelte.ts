// What the parts of a map's page share: the version that is shown, its scene, and what is chosen in it.

import { getContext, setContext } from 'svelte';

import { fetchReport, type Report } from '../api/map_files';
import type { MapVersion, Vector } from '../api/types';
import { navigation } from '../shell/navigation.svelte';
import { geoJsonFromSite, siteFromGeoJson } from '../scene/geo';
import { kPalette } from '../scene/ground_look';
import type { MapScene } from '../scene/map_scene';
import { selectionOfText, textOfSelection } from './selection_text';

const kTabs = ['info', 'time', 'loops', 'measure', 'review', 'pins', 'share'] as const;
export type Tab = (typeof kTabs)[number];

/** Who is told of clicks into the picture; "look" is what they mean when no tool is chosen. */
export type Tool = 'look' | 'measure' | 'pin' | 'comment' | 'pair';

export interface MapDrive {
  id: string;
  name: string;
  color: number; // the same in all layers and lists
}

/** What is chosen, in the picture and in lists alike. */
export type Selection =
  | { kind: 'point'; point: Vector }
  | { kind: 'slot'; id: string; point: Vector }
  | { kind: 'loop'; id: string; point: Vector }
  | { kind: 'comment'; id: string; point: Vector | null }
  | { kind: 'measurement'; id: string; point: Vector };

export class Workspace {
  readonly drives: MapDrive[];
  /** Turns positions of this map's GeoJSON into points of the site. */
  readonly toSite: (position: number[]) => Vector;
  /** The way back: [longitude, latitude, height], or the point itself where the map is not georeferenced. */
  readonly toGeoJson: (point: Vector) => [number, number, number];
  scene: MapScene | null = $state.raw(null);
  tab: Tab = $state('info');
  tool: Tool = $state('look');
  selection: Selection | null = $state.raw(null);
  /** The time that plots, pictures and the car in the scene show: [s] since the start of a drive's plots. */
  time: { drive: string; seconds: number } | null = $state.raw(null);

  private constructor(
    readonly map: MapVersion,
    readonly report: Report,
  ) {
    this.drives = map.drives.map(({ id, name }, i) => ({ id, name, color: kPalette[i % kPalette.length]! }));
    this.toSite = siteFromGeoJson(map.datum);
    this.toGeoJson = geoJsonFromSite(map.datum);
    this.readAddress();
  }

  static async of(map: MapVersion): Promise<Workspace> {
    return new Workspace(map, await fetchReport(map));
  }

  driveNamed(name: string): MapDrive | undefined {
    return this.drives.find((drive) => drive.name === name);
  }

  /** Opens a panel; the address says which. */
  open(tab: Tab): void {
    this.tab = tab;
    this.tool = 'look';
    navigation.setQuery({ tab: tab === 'info' ? null : tab });
  }

  /** Chooses something, and turns the camera to it where that is wanted; the address says what. */
  select(selection: Selection | null, isLookedAt = false): void {
    this.selection = selection;
    navigation.setQuery({ chosen: selection ? textOfSelection(selection) : null });
    if (isLookedAt && selection?.point) this.scene?.lookAt(selection.point, 30);
  }

  setTime(drive: string, seconds: number): void {
    this.time = { drive, seconds };
    navigation.setQuery({ drive, t: seconds.toFixed(2) });
  }

  private readAddress(): void {
    const { query } = navigation;
    const tab = query.get('tab');
    if (kTabs.some((known) => known === tab)) this.tab = tab as Tab;
    this.selection = selectionOfText(query.get('chosen'));
    const [drive, seconds] = [query.get('drive'), Number(query.get('t'))];
    if (drive !== null && this.drives.some(({ id }) => id === drive) && Number.isFinite(seconds))
      this.time = { drive, seconds };
  }
}

const kKey = Symbol('workspace');
export const provideWorkspace = (workspace: Workspace) => setContext(kKey, workspace);
export const useWorkspace = () => getContext<Workspace>(kKey);
