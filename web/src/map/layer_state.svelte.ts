// Which layers of a map are shown, and how. It outlives the panel that chooses: the address holds it.

import type { FreeSpaceProperties, SlotProperties } from '../api/map_files';
import { callerState } from '../shell/caller.svelte';
import { navigation } from '../shell/navigation.svelte';
import { decksOf, sliceOf, type Deck } from '../scene/decks';
import type { PathColor } from '../scene/layers/path_colors';
import { disposeOf, type MapScene } from '../scene/map_scene';
import { DriveData } from './drive_data';
import { coloringOf } from './ground_coloring';
import {
  groundColorOfText, layersOfText, pathColorOfText, sliceOfText, textOfLayers, textOfSlice, type GroundColor, type LayerName, type Shown,
} from './layer_address';
import { kLayers } from './layer_sources';
import type { Legend } from './legend';
import type { Workspace } from './workspace.svelte';

export interface LayerStatus {
  stage: 'waiting' | 'loading' | 'ready' | 'failed';
  count: number | null;
  note: string; // what a reader should know; why it failed
  legend: Legend | null;
}

const kWaiting: LayerStatus = { stage: 'waiting', count: null, note: '', legend: null };
const sentence = (reason: unknown) => (reason instanceof Error ? reason.message : String(reason));

export class LayerState {
  shown: Shown = $state(layersOfText(navigation.query.get('layers')));
  status: Record<string, LayerStatus> = $state({});
  pathColor: PathColor = $state(pathColorOfText(navigation.query.get('path')));
  groundColor: GroundColor = $state(groundColorOfText(navigation.query.get('color')));
  groundLegend: Legend | null = $state.raw(null);
  groundNote = $state('');
  isColoring = $state(false);
  decks: Deck[] = $state.raw([]);
  level: number | null = $state(null);
  slice: { low: number; high: number } | null = $state.raw(null);
  slots: SlotProperties[] = $state.raw([]);
  readonly data: DriveData;
  private scene: MapScene | null = null;
  private coloringTurn = 0; // what was asked for last counts

  constructor(private readonly workspace: Workspace) {
    this.data = new DriveData(workspace.map);
  }

  /** Layers that this caller may see. */
  get listed() {
    return kLayers.filter(({ isOfDrives }) => !isOfDrives || callerState.seesDrives);
  }

  get legends(): Legend[] {
    const ofLayers = this.listed.flatMap(({ name }) => (this.shown[name] ? (this.status[name]?.legend ?? []) : []));
    return [...(this.groundLegend ? [this.groundLegend] : []), ...ofLayers];
  }

  statusOf(name: LayerName): LayerStatus {
    return this.status[name] ?? kWaiting;
  }

  /** Shows all that the address asks for in a scene. Returns what leaves it. */
  attach(scene: MapScene): () => void {
    this.scene = scene;
    this.status = {};
    for (const { name } of this.listed) this.apply(name);
    void this.color();
    this.data
      .collection<FreeSpaceProperties>('free_space.geojson')
      .then((freeSpace) => this.takeDecks(decksOf(freeSpace)))
      .catch(() => undefined); // the layer of free space says why
    this.data
      .collection<SlotProperties>('slots.geojson')
      .then(({ features }) => (this.slots = features.map(({ properties }) => properties)))
      .catch(() => undefined); // and that of slots
    return () => (this.scene = null);
  }

  show(name: LayerName, isShown: boolean): void {
    this.shown[name] = isShown;
    navigation.setQuery({ layers: textOfLayers(this.shown) });
    this.apply(name);
  }

  choosePathColor(color: PathColor): void {
    this.pathColor = color;
    navigation.setQuery({ path: color === 'drive' ? null : color });
    void this.load('paths');
  }

  chooseGroundColor(color: GroundColor): void {
    this.groundColor = color;
    navigation.setQuery({ color: color === 'picture' ? null : color });
    void this.color();
  }

  /** Null: all of them. */
  chooseLevel(level: number | null): void {
    this.level = level;
    this.slice = level === null ? null : sliceOf(this.decks, level);
    navigation.setQuery({ level: level === null ? null : String(level), slice: null });
    this.scene?.setSlice(this.slice);
    if (this.groundColor === 'height') void this.color();
  }

  /** Shows what lies between two heights, [m] in site; null: everything. */
  chooseSlice(slice: { low: number; high: number } | null): void {
    const wasOfLevel = this.level !== null;
    this.level = null;
    this.slice = slice;
    navigation.setQuery({ level: null, slice: slice ? textOfSlice(slice) : null });
    this.scene?.setSlice(slice);
    if (wasOfLevel && this.groundColor === 'height') void this.color();
  }

  private takeDecks(decks: Deck[]): void {
    this.decks = decks;
    const wanted = navigation.query.get('level');
    const found = wanted === null ? undefined : decks.find(({ level }) => String(level) === wanted);
    if (found && decks.length > 1) this.chooseLevel(found.level);
    else {
      this.slice = sliceOfText(navigation.query.get('slice'));
      this.scene?.setSlice(this.slice);
    }
  }

  private apply(name: LayerName): void {
    if (name === 'ground') this.scene?.setGroundVisible(this.shown.ground);
    else {
      this.scene?.setLayerVisible(nameInScene(name), this.shown[name]);
      const { stage } = this.statusOf(name);
      const isEmpty = this.listed.find((known) => known.name === name)?.count(this.workspace) === 0;
      if (this.shown[name] && !isEmpty && (stage === 'waiting' || stage === 'failed')) void this.load(name);
    }
  }

  private async load(name: LayerName): Promise<void> {
    const { scene, workspace, data, pathColor } = this;
    const source = this.listed.find((known) => known.name === name);
    if (!scene || !source) return;
    this.status[name] = { ...this.statusOf(name), stage: 'loading', note: '' };
    try {
      const { objects, count, note = '', legend = null } = await source.load({ workspace, data, scene, pathColor });
      const isStale = name === 'paths' && pathColor !== this.pathColor;
      if (this.scene !== scene || isStale) return objects.forEach(disposeOf);
      scene.fillLayer(nameInScene(name), ...objects);
      this.status[name] = { stage: 'ready', count, note, legend };
    } catch (error) {
      this.status[name] = { stage: 'failed', count: null, note: sentence(error), legend: null };
    }
  }

  private async color(): Promise<void> {
    const { scene, workspace, data, groundColor, level } = this;
    const deck = this.decks.find((known) => known.level === level) ?? null;
    const turn = ++this.coloringTurn;
    const isWanted = () => this.scene === scene && this.coloringTurn === turn;
    this.isColoring = true;
    this.groundNote = '';
    try {
      const { colors, legend } = await coloringOf(groundColor, workspace, data, deck);
      if (!isWanted()) return;
      scene?.colorGround(colors);
      this.groundLegend = legend;
    } catch (error) {
      if (!isWanted()) return;
      this.groundNote = sentence(error);
      this.groundLegend = null;
      scene?.colorGround({ by: 'picture' });
    }
    this.isColoring = false;
  }
}

/** Names of these layers' groups: other parts have layers of their own. */
export const nameInScene = (name: LayerName) => `map:${name}`;

const known = new WeakMap<Workspace, LayerState>();

export function layersOf(workspace: Workspace): LayerState {
  let layers = known.get(workspace);
  if (!layers) known.set(workspace, (layers = new LayerState(workspace)));
  return layers;
}
