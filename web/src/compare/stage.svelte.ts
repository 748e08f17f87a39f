// The two scenes of a comparison: both grounds, cameras that look at the same place, and the changes in both.

import { Mesh, MeshBasicMaterial, DoubleSide, Raycaster, Vector2, type BufferGeometry } from 'three';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { acceleratedRaycast, MeshBVH } from 'three-mesh-bvh';

import { fileUrl } from '../api/map_files';
import type { MapVersion } from '../api/types';
import { MapScene, type Bounds } from '../scene/map_scene';
import type { Change } from './changes';
import { colorByDifference, differenceOf, EarlierHeights, rangeOf } from './height_difference';
import { linkViews } from './linked_views';
import type { LoadedComparison } from './loaded';
import { drawChanges } from './outlines';

const kMaxBytes = 120e6; // of a ground that is loaded whole
const kClosest = 14; // [m] from which a change is looked at
const kLeastRange = 0.02; // [m]

export class CompareStage {
  readonly later: MapScene;
  readonly earlier: MapScene;
  /** [m] at both ends of the ramp of heights; null before those are known. */
  range: number | null = $state(null);
  /** [m] under the pointer, later minus earlier. */
  under: number | null = $state(null);
  private readonly stops: (() => void)[] = [];
  private difference: Mesh<BufferGeometry, MeshBasicMaterial> | null = null;
  private isOpen = true;

  constructor(
    private readonly loaded: LoadedComparison,
    private readonly laterCanvas: HTMLCanvasElement,
    earlierCanvas: HTMLCanvasElement,
  ) {
    this.later = new MapScene(laterCanvas);
    this.earlier = new MapScene(earlierCanvas);
    const layer = this.earlier.layer('changes');
    loaded.laterFromEarlier.clone().invert().decompose(layer.position, layer.quaternion, layer.scale);
  }

  /** Resolves when something of both is there. */
  async open(): Promise<void> {
    const open = (scene: MapScene, map: MapVersion) => scene.open(fileUrl(map, 'tileset.json'), map.bounds as Bounds | null);
    const both = [open(this.later, this.loaded.later), open(this.earlier, this.loaded.earlier)];
    this.later.lookAround();
    this.stops.push(linkViews(this.later, this.earlier, this.loaded.laterFromEarlier));
    await Promise.all(both);
  }

  drawChanges(chosen: Change | null, isShown: boolean): void {
    for (const scene of [this.later, this.earlier]) scene.fillLayer('changes', ...(isShown ? drawChanges(this.loaded.changes, chosen) : []));
  }

  lookAtChange({ point, reach }: Change): void {
    if (point) this.later.lookAt(point, Math.max(kClosest, 4 * reach));
  }

  /** Shows the signed difference of heights in place of the later ground. Loads both grounds whole the first time. */
  async showHeights(): Promise<void> {
    this.difference ??= await this.makeDifference();
    if (!this.isOpen || !this.difference) return;
    this.later.layer('heights').add(this.difference);
    this.later.setLayerVisible('heights', true);
    this.later.setGroundVisible(false);
  }

  hideHeights(): void {
    if (!this.isOpen) return;
    this.later.setLayerVisible('heights', false);
    this.later.setGroundVisible(true);
    this.under = null;
  }

  setRange(range: number): void {
    this.range = range;
    if (!this.difference) return;
    colorByDifference(this.difference.geometry, range);
    this.later.requestFrame();
  }

  /** Reads the difference under a pixel of the window. */
  readUnder(clientX: number, clientY: number): void {
    if (!this.difference) return;
    const frame = this.laterCanvas.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * (clientX - frame.left)) / frame.width - 1, 1 - (2 * (clientY - frame.top)) / frame.height), this.later.camera);
    const face = ray.intersectObject(this.difference)[0]?.face;
    const value = face ? this.difference.geometry.getAttribute('difference').getX(face.a) : NaN;
    this.under = Number.isNaN(value) ? null : value;
  }

  dispose(): void {
    this.isOpen = false;
    for (const stop of this.stops) stop();
    this.later.dispose();
    this.earlier.dispose();
  }

  private async makeDifference(): Promise<Mesh<BufferGeometry, MeshBasicMaterial> | null> {
    const [later, earlier] = await Promise.all([this.loaded.later, this.loaded.earlier].map(loadGround));
    const heights = new EarlierHeights(earlier!, this.loaded.laterFromEarlier);
    const geometry = await differenceOf(later!, heights, () => this.isOpen);
    if (!geometry) return null;
    const differences = geometry.getAttribute('difference').array;
    this.range = niceRange(rangeOf(differences, 0.98));
    colorByDifference(geometry, this.range);
    (geometry as BufferGeometry & { boundsTree?: MeshBVH }).boundsTree = new MeshBVH(geometry);
    const mesh = new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }));
    mesh.raycast = acceleratedRaycast;
    return mesh;
  }
}

export const kRanges = [0.02, 0.05, 0.1, 0.2, 0.5]; // [m]

/** The least of the ranges that holds a difference. */
const niceRange = (difference: number): number => kRanges.find((range) => range >= Math.max(difference, kLeastRange)) ?? kRanges.at(-1)!;

async function loadGround(map: MapVersion): Promise<BufferGeometry> {
  const file = map.files.find(({ name }) => name === 'ground.ply');
  if (!file) throw new Error(`version ${map.version} has no ground.ply: heights cannot be compared here`);
  if (file.bytes > kMaxBytes) throw new Error(`the ground of version ${map.version} is too large for the browser (${Math.round(file.bytes / 1e6)} MB): see the list of changes`);
  return new PLYLoader().loadAsync(fileUrl(map, 'ground.ply'));
}
