// The ground of a map, streamed as 3D Tiles: what is near and in view comes finer, the rest coarser or not at all.

import { TilesRenderer } from '3d-tiles-renderer';
import { Scheduler } from '3d-tiles-renderer/core';
import { GLTFExtensionsPlugin } from '3d-tiles-renderer/plugins';
import * as THREE from 'three';
import type { DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { acceleratedRaycast, MeshBVH } from 'three-mesh-bvh';

import { takeEarly } from '../api/early';
import type { GroundColors, GroundLook } from './ground_look';

const kErrorTarget = 6; // [px] that a tile may be off before a finer one is asked for
const kHurry = 16; // [ms] between two looks at what the first tile waits for
const kDeferred = 3; // steps from the tileset to a request
const kWholeOnly = 1e9; // [px] no tile but the first one is as wrong as that
const kMaxBytes = 192 * 2 ** 20; // of tiles that are kept

interface LoadedTile {
  scene: THREE.Object3D;
  meshes: { mesh: THREE.Mesh; siteFromMesh: THREE.Matrix4 }[];
}

export class GroundTiles {
  readonly group: THREE.Group;
  onError: ((message: string) => void) | null = null;
  /** Whether there is a tile to draw, or known that none is to be had where the camera looks. */
  isThere = false;
  private readonly tiles: TilesRenderer;
  private timer = 0;
  private readonly loaded = new Map<THREE.Object3D, LoadedTile>();

  constructor(
    url: string,
    draco: DRACOLoader,
    private readonly look: GroundLook,
    private readonly camera: THREE.Camera,
    renderer: THREE.WebGLRenderer,
    requestFrame: () => void,
  ) {
    this.tiles = new TilesRenderer(url);
    this.tiles.registerPlugin({ fetchData: takeEarly });
    this.tiles.registerPlugin(new GLTFExtensionsPlugin({ dracoLoader: draco, autoDispose: false }));
    this.tiles.errorTarget = kWholeOnly;
    this.tiles.lruCache.maxBytesSize = kMaxBytes;
    this.tiles.lruCache.minBytesSize = 0.75 * kMaxBytes;
    this.tiles.setCamera(camera);
    this.tiles.setResolutionFromRenderer(camera, renderer);
    this.group = this.tiles.group;
    this.tiles.addEventListener('load-root-tileset', () => {
      // The root lies on the ellipsoid where the map is georeferenced; the scene is the site.
      const transform = (this.tiles.rootTileset as { root?: { transform?: number[] } } | null)?.root?.transform;
      if (transform) this.group.matrix.fromArray(transform).invert().decompose(this.group.position, this.group.quaternion, this.group.scale);
      this.group.updateMatrixWorld(true);
      requestFrame();
    });
    this.tiles.addEventListener('load-model', ({ scene }) => {
      this.take(scene);
      requestFrame();
    });
    this.tiles.addEventListener('tile-visibility-change', ({ visible }) => {
      if (visible) this.isThere = true;
    });
    this.tiles.addEventListener('dispose-model', ({ scene }) => this.loaded.delete(scene));
    this.tiles.addEventListener('load-error', ({ error }) => {
      this.isThere = true;
      this.onError?.(error.message);
      requestFrame();
    });
    for (const event of ['needs-update', 'tile-visibility-change', 'tiles-load-end'] as const)
      this.tiles.addEventListener(event, requestFrame);
    this.timer = window.setTimeout(() => this.hurry(renderer));
  }

  /** Asks for the first tile without waiting for frames, which take long where no graphics card is. */
  private hurry(renderer: THREE.WebGLRenderer): void {
    if (this.isThere) return;
    this.camera.updateMatrixWorld();
    this.update(renderer);
    this.timer = window.setTimeout(() => this.hurry(renderer), kHurry);
  }

  /** To be called before each frame. */
  update(renderer: THREE.WebGLRenderer): void {
    this.tiles.setResolutionFromRenderer(this.camera, renderer);
    this.tiles.update();
    if (this.tiles.root?.traversal.inFrustum === false) this.isThere = true;
    // What it defers to the next frame is done now.
    for (let i = 0; i < kDeferred && !this.isThere; ++i) Scheduler.flushPending();
  }

  /** Asks for what is finer than the tile of the whole, once that is drawn: it would have had to wait for all of them. */
  refine(): void {
    this.tiles.errorTarget = kErrorTarget;
  }

  recolor(colors: GroundColors): void {
    this.look.set(colors);
    for (const { meshes } of this.loaded.values())
      for (const { mesh, siteFromMesh } of meshes) this.look.fillValues(mesh, siteFromMesh);
  }

  /** Meshes that are shown now, for picking. */
  get shown(): THREE.Object3D[] {
    return [...this.loaded.values()].filter(({ scene }) => scene.parent !== null).map(({ scene }) => scene);
  }

  get isLoading(): boolean {
    return this.tiles.loadProgress < 1;
  }

  dispose(): void {
    clearTimeout(this.timer);
    this.tiles.dispose();
    this.loaded.clear();
  }

  private take(scene: THREE.Object3D): void {
    scene.updateMatrixWorld(true);
    const siteFromTileset = new THREE.Matrix4().copy(this.group.matrixWorld);
    const meshes: LoadedTile['meshes'] = [];
    scene.traverse((object) => {
      if (!(object instanceof THREE.Mesh)) return;
      const siteFromMesh = siteFromTileset.clone().multiply(object.matrixWorld);
      this.look.apply(object, siteFromMesh);
      (object.geometry as THREE.BufferGeometry & { boundsTree?: MeshBVH }).boundsTree = new MeshBVH(object.geometry);
      object.raycast = acceleratedRaycast;
      meshes.push({ mesh: object, siteFromMesh });
    });
    this.loaded.set(scene, { scene, meshes });
  }
}
