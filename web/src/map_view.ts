import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { DRACO_GLTF_CONFIG, DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

import type { SlotCollection, SurfaceCollection, Vector } from './api';
import { colorsByHeight } from './height_colors';
import { makePinLayer, type PinMark } from './pin_layer';
import { gltfFromSite, siteFromGltf } from './pins';
import { makeSlotLayer } from './slot_layer';
import { makeSurfaceLayer } from './surface_layer';

export type ColorMode = 'photo' | 'height';

const kTrajectoryColors = [0x39c0ff, 0xffb020, 0x6fe38a, 0xff6b8b, 0xb48cff];

const kMargin = 1.08; // around what is looked at

/** How a mesh looks when it shows photographs: vertex colors, or a picture. */
interface PhotoLook {
  colors: THREE.BufferAttribute | THREE.InterleavedBufferAttribute | undefined;
  picture: THREE.Texture | null;
}

/** One map in one canvas: load, look at it from above or around, switch layers. */
export class MapView {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(50, 1, 0.1, 5000);
  private readonly controls: OrbitControls;
  private readonly loader = new GLTFLoader();
  private readonly photoLooks = new Map<THREE.Object3D, PhotoLook>();
  private content: THREE.Object3D | null = null;
  private slotLayer: THREE.Group | null = null;
  private surfaceLayer: THREE.Group | null = null;
  private areSlotsVisible = true; // this and the next four outlive the map that is shown
  private areSurfacesVisible = false;
  private isGroundVisible = true;
  private areTrajectoriesVisible = true;
  private colorMode: ColorMode = 'photo';
  private pinLayer: THREE.Group | null = null;
  private coveredHeight = 0;
  private isFrameRequested = false;
  private generation = 0;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.scene.background = new THREE.Color(0x12161d);
    const draco = new DRACOLoader();
    draco.setDecoderPath(DRACO_GLTF_CONFIG); // bundled with the page: no CDN
    this.loader.setDRACOLoader(draco);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8d99a8, 3));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI * 0.495; // never below the ground
    this.controls.addEventListener('change', () => this.requestFrame());
    this.watchClicks();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement ?? canvas);
    this.resize();
  }

  /** Replaces what is shown, seen as before; resolves false when a later load overtook this one. */
  async load(url: string): Promise<boolean> {
    this.generation += 1;
    const generation = this.generation;
    const gltf = await this.loader.loadAsync(url);
    if (generation !== this.generation) return false;
    this.clear();
    this.content = gltf.scene;
    this.prepare(gltf.scene);
    this.scene.add(gltf.scene);
    this.setGroundVisible(this.isGroundVisible);
    this.setTrajectoriesVisible(this.areTrajectoriesVisible);
    this.setColorMode(this.colorMode);
    return true;
  }

  clear(): void {
    if (!this.content) return;
    this.scene.remove(this.content);
    this.content.traverse((object) => {
      if (object instanceof THREE.Mesh || object instanceof THREE.Line) {
        object.geometry.dispose();
        for (const material of [object.material].flat()) {
          this.photoLooks.get(object)?.picture?.dispose();
          material.dispose();
        }
      }
    });
    this.photoLooks.clear();
    this.content = null;
    this.slotLayer = null; // parts of the content
    this.surfaceLayer = null;
    this.pinLayer = null;
    this.requestFrame();
  }

  /** From the south, 45 degrees down, everything in view. */
  lookAround(): void {
    this.lookFrom(new THREE.Vector3(0, 1, 0.9));
  }

  /** Straight down, north up. */
  lookDown(): void {
    this.lookFrom(new THREE.Vector3(0, 1, 1e-4));
  }

  /** Parking slots of the map that is shown. */
  setSlots(slots: SlotCollection): void {
    if (!this.content) return;
    if (this.slotLayer) this.content.remove(this.slotLayer);
    this.slotLayer = makeSlotLayer(slots);
    this.slotLayer.visible = this.areSlotsVisible;
    this.content.add(this.slotLayer);
    this.requestFrame();
  }

  /** What lies beside the free space of the map that is shown. */
  setSurfaces(surfaces: SurfaceCollection, toSite: (position: number[]) => Vector): void {
    if (!this.content) return;
    if (this.surfaceLayer) this.content.remove(this.surfaceLayer);
    this.surfaceLayer = makeSurfaceLayer(surfaces, toSite);
    this.surfaceLayer.visible = this.areSurfacesVisible;
    this.content.add(this.surfaceLayer);
    this.requestFrame();
  }

  setSurfacesVisible(isVisible: boolean): void {
    this.areSurfacesVisible = isVisible;
    if (this.surfaceLayer) this.surfaceLayer.visible = isVisible;
    this.requestFrame();
  }

  /** Numbered marks on the ground; they take the place of those before. */
  setPins(pins: PinMark[]): void {
    if (!this.content) return;
    if (this.pinLayer) this.content.remove(this.pinLayer);
    this.pinLayer = makePinLayer(pins);
    this.content.add(this.pinLayer);
    this.requestFrame();
  }

  /** Where the middle of the picture meets the ground, in the site. */
  pickMiddle(): Vector | null {
    return this.pick(new THREE.Vector2(0, 0));
  }

  /** Called with the point of the ground that is clicked; null: clicks mean nothing. */
  onPick: ((point: Vector) => void) | null = null;

  /** Where a point of the site is in the picture, [px] from its upper left corner. */
  screenPosition(point: Vector): [number, number] {
    const projected = new THREE.Vector3(...gltfFromSite(point)).project(this.camera);
    return [((projected.x + 1) / 2) * this.canvas.clientWidth, ((1 - projected.y) / 2) * this.canvas.clientHeight];
  }

  setSlotsVisible(isVisible: boolean): void {
    this.areSlotsVisible = isVisible;
    if (this.slotLayer) this.slotLayer.visible = isVisible;
    this.requestFrame();
  }

  setTrajectoriesVisible(isVisible: boolean): void {
    this.areTrajectoriesVisible = isVisible;
    this.forEachNode('drive:', (node) => (node.visible = isVisible));
  }

  setGroundVisible(isVisible: boolean): void {
    this.isGroundVisible = isVisible;
    this.forEachNode('ground', (node) => (node.visible = isVisible));
  }

  setColorMode(mode: ColorMode): void {
    this.colorMode = mode;
    this.content?.traverse((object) => {
      const look = this.photoLooks.get(object);
      if (!(object instanceof THREE.Mesh) || !look) return; // slots keep their colors
      const material = object.material as THREE.MeshBasicMaterial;
      const geometry = object.geometry as THREE.BufferGeometry;
      if (mode === 'height') geometry.setAttribute('color', colorsByHeight(geometry));
      else if (look.colors) geometry.setAttribute('color', look.colors);
      else geometry.deleteAttribute('color');
      material.vertexColors = geometry.hasAttribute('color');
      material.map = mode === 'height' ? null : look.picture;
      material.needsUpdate = true;
    });
    this.requestFrame();
  }

  private pick(at: THREE.Vector2): Vector | null {
    const grounds: THREE.Object3D[] = [];
    this.forEachNode('ground', (node) => grounds.push(node));
    const ray = new THREE.Raycaster();
    ray.setFromCamera(at, this.camera);
    const hit = ray.intersectObjects(grounds).at(0);
    return hit ? siteFromGltf(hit.point.toArray()) : null;
  }

  // A click is a press that does not move: dragging turns the map.
  private watchClicks(): void {
    const kSteady = 4; // [px]
    let pressed: [number, number] | null = null;
    this.canvas.addEventListener('pointerdown', (event) => {
      pressed = event.button === 0 ? [event.clientX, event.clientY] : null;
    });
    this.canvas.addEventListener('pointerup', (event) => {
      if (!pressed || !this.onPick) return;
      if (Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > kSteady) return;
      const frame = this.canvas.getBoundingClientRect();
      const point = this.pick(
        new THREE.Vector2(
          (2 * (event.clientX - frame.left)) / frame.width - 1,
          1 - (2 * (event.clientY - frame.top)) / frame.height,
        ),
      );
      if (point) this.onPick(point);
    });
  }

  private prepare(root: THREE.Object3D): void {
    let trajectory = 0;
    const anisotropy = this.renderer.capabilities.getMaxAnisotropy();
    root.traverse((object) => {
      if (object instanceof THREE.Mesh) {
        const material = object.material as THREE.MeshBasicMaterial;
        material.side = THREE.DoubleSide;
        if (material.map) material.map.anisotropy = anisotropy; // ground is mostly seen at a low angle
        this.photoLooks.set(object, { colors: object.geometry.getAttribute('color'), picture: material.map });
      } else if (object instanceof THREE.Line) {
        const color = kTrajectoryColors[trajectory % kTrajectoryColors.length];
        object.material = new THREE.LineBasicMaterial({ color, depthTest: false });
        object.renderOrder = 1; // the car drove on the ground, not in it
        trajectory += 1;
      }
    });
  }

  private forEachNode(prefix: string, change: (node: THREE.Object3D) => void): void {
    this.content?.traverse((object) => {
      // three replaces characters that its animation paths reserve, ':' among them.
      const name = (object.userData['name'] as string | undefined) ?? object.name;
      if (name.startsWith(prefix) || name.startsWith(prefix.replace(':', ''))) change(object);
    });
    this.requestFrame();
  }

  /** Pixels at the lower edge of the canvas that something covers: what is looked at keeps clear of them. */
  setCoveredHeight(pixels: number): void {
    this.coveredHeight = pixels;
    this.resize();
  }

  /** Share of the canvas's height that nothing covers, at least half. */
  private freeShare(): number {
    return Math.max(0.5, 1 - this.coveredHeight / Math.max(1, this.canvas.clientHeight));
  }

  /** As near as everything is in view, from a direction that points from the map to the eye. */
  private lookFrom(direction: THREE.Vector3): void {
    if (!this.content) return;
    const box = new THREE.Box3().setFromObject(this.content);
    const center = box.getCenter(new THREE.Vector3());
    const back = direction.clone().normalize();
    const right = new THREE.Vector3(0, 1, 0).cross(back).normalize();
    const up = back.clone().cross(right);
    const halfHeight = Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2));
    let distance = 2;
    for (let i = 0; i < 8; ++i) {
      const corner = new THREE.Vector3(
        i & 1 ? box.max.x : box.min.x,
        i & 2 ? box.max.y : box.min.y,
        i & 4 ? box.max.z : box.min.z,
      ).sub(center);
      const sideways = Math.abs(corner.dot(right)) / (halfHeight * this.camera.aspect);
      const upwards = Math.abs(corner.dot(up)) / (halfHeight * this.freeShare());
      distance = Math.max(distance, corner.dot(back) + kMargin * Math.max(sideways, upwards));
    }
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(back, distance);
    this.camera.near = distance / 1000;
    this.camera.far = distance * 10;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.requestFrame();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement ?? this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    // The middle of what is free is the middle of the picture.
    const shift = ((1 - this.freeShare()) / 2) * clientHeight;
    this.camera.setViewOffset(clientWidth, clientHeight, 0, shift, clientWidth, clientHeight);
    this.requestFrame();
  }

  // Drawn only when something changed: an idle page costs nothing.
  private requestFrame(): void {
    if (this.isFrameRequested) return;
    this.isFrameRequested = true;
    requestAnimationFrame(() => {
      this.isFrameRequested = false;
      this.renderer.render(this.scene, this.camera);
    });
  }
}
