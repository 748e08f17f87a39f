// One map in one canvas. The scene is the site: x, y, z in meters, z up. Layers are groups in it, by name.

import * as THREE from 'three';
import { MapControls } from 'three/examples/jsm/controls/MapControls.js';

import type { Vector } from '../api/types';
import { dracoDecoder } from './draco';
import { GroundLook, type GroundColors } from './ground_look';
import { GroundTiles } from './ground_tiles';

export interface Bounds {
  min: Vector;
  max: Vector;
}

/** Where the camera is and what it looks at, [m] in site. */
export interface CameraView {
  position: Vector;
  target: Vector;
}

export interface GroundHit {
  point: Vector; // [m] in site
  /** The layer's object that lies there, where it is one that can be chosen; else the ground. */
  object: THREE.Object3D | null;
}

interface Events {
  click: (hit: GroundHit | null, event: PointerEvent) => void;
  hover: (point: Vector | null) => void;
  view: () => void; // the camera moved
  frame: () => void; // something was drawn
}

const kMargin = 1.08; // around what is looked at
const kNearest = 5; // [m] from which all is looked at
const kSteady = 4; // [px] by which a pointer may move in a click
const kStill = 1e-3; // [m] by which a camera is not moved
const kKeyStep = 40; // [px] by which an arrow key moves the map
const kHighest = 1e9; // [m]

dracoDecoder(); // it is ready when the scene is

export class MapScene {
  readonly world = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(45, 1, 0.2, 8000);
  readonly controls: MapControls;
  readonly renderer: THREE.WebGLRenderer;
  readonly look = new GroundLook();
  ground: GroundTiles | null = null;
  private readonly layers = new Map<string, THREE.Group>();
  private readonly listeners: { [Name in keyof Events]: Set<Events[Name]> } = {
    click: new Set(),
    hover: new Set(),
    view: new Set(),
    frame: new Set(),
  };
  private readonly slice = { low: -kHighest, high: kHighest };
  private readonly observer: ResizeObserver;
  private bounds: Bounds = { min: [-10, -10, 0], max: [10, 10, 1] };
  private frame = 0;
  private whole: { direction: THREE.Vector3; position: THREE.Vector3 } | null = null; // the last view of everything
  private sample: THREE.Mesh | null = null; // holds what was compiled for it

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera.up.set(0, 0, 1);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8d99a8, 3));
    this.controls = new MapControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI * 0.495; // never below the ground
    this.controls.zoomToCursor = true;
    canvas.tabIndex = 0; // arrows move the map, and with Shift turn it
    this.controls.keyPanSpeed = kKeyStep;
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener('change', () => {
      this.emit('view');
      this.requestFrame();
    });
    this.watchPointer();
    canvas.addEventListener('cost', (event) => this.tellCost(event as CustomEvent<object>));
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas.parentElement ?? canvas);
    this.resize();
    this.warmUp();
  }

  /** Shows the ground of a tileset. Resolves when the first of it is in the picture. */
  open(tilesetUrl: string, bounds: Bounds | null): Promise<void> {
    this.closeGround();
    if (bounds) this.bounds = bounds;
    const ground = new GroundTiles(tilesetUrl, dracoDecoder(), this.look, this.camera, this.renderer, () => this.requestFrame());
    this.ground = ground;
    this.world.add(ground.group);
    this.requestFrame();
    return new Promise((resolve, reject) => {
      const stop = this.on('frame', () => {
        stop();
        // Another frame begins when this one is on the screen.
        requestAnimationFrame(() => {
          ground.refine();
          this.requestFrame();
          resolve();
        });
      });
      ground.onError = (message) => reject(new Error(message));
    });
  }

  /** The group of a layer, in the site's frame; made when it is first asked for. */
  layer(name: string): THREE.Group {
    let group = this.layers.get(name);
    if (!group) {
      group = new THREE.Group();
      group.name = name;
      this.layers.set(name, group);
      this.world.add(group);
    }
    return group;
  }

  /** Puts these in place of what a layer had. */
  fillLayer(name: string, ...content: THREE.Object3D[]): void {
    const group = this.layer(name);
    for (const object of [...group.children]) disposeOf(object);
    group.clear();
    if (content.length > 0) group.add(...content);
    this.requestFrame();
  }

  setLayerVisible(name: string, isVisible: boolean): void {
    this.layer(name).visible = isVisible;
    this.requestFrame();
  }

  setGroundVisible(isVisible: boolean): void {
    if (this.ground) this.ground.group.visible = isVisible;
    this.requestFrame();
  }

  colorGround(colors: GroundColors): void {
    if (this.ground) this.ground.recolor(colors);
    else this.look.set(colors);
    this.requestFrame();
  }

  /** Shows only what lies between two heights, [m] in site; null: everything. */
  setSlice(slice: { low: number; high: number } | null): void {
    this.slice.low = slice?.low ?? -kHighest;
    this.slice.high = slice?.high ?? kHighest;
    this.renderer.clippingPlanes = slice
      ? [new THREE.Plane(new THREE.Vector3(0, 0, 1), -slice.low), new THREE.Plane(new THREE.Vector3(0, 0, -1), slice.high)]
      : [];
    this.requestFrame();
  }

  /** Oblique from the south, everything in view. */
  lookAround(): void {
    this.lookFrom(new THREE.Vector3(0, -0.9, 1));
  }

  /** Straight down, north up. */
  lookDown(): void {
    this.lookFrom(new THREE.Vector3(0, -1e-4, 1));
  }

  /** Turns the camera about what it looks at so that north is up. */
  turnNorth(): void {
    const { target } = this.controls;
    const offset = this.camera.position.clone().sub(target);
    const across = Math.hypot(offset.x, offset.y);
    this.camera.position.set(target.x, target.y - Math.max(across, 1e-4), this.camera.position.z);
    this.controls.update();
  }

  /** Moves the camera to a point, from the direction that it looks from now, `distance` meters off. */
  lookAt(point: Vector, distance?: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = distance ?? Math.min(offset.length(), 60);
    this.controls.target.set(...point);
    this.camera.position.copy(this.controls.target).addScaledVector(offset.normalize(), length);
    this.controls.update();
    this.requestFrame();
  }

  get view(): CameraView {
    return { position: this.camera.position.toArray(), target: this.controls.target.toArray() };
  }

  set view({ position, target }: CameraView) {
    this.camera.position.set(...position);
    this.controls.target.set(...target);
    this.controls.update();
    this.requestFrame();
  }

  /** [radians] by which the picture's up lies clockwise of north. */
  get heading(): number {
    const toTarget = this.controls.target.clone().sub(this.camera.position);
    if (Math.hypot(toTarget.x, toTarget.y) < 1e-6) return 0;
    return Math.atan2(toTarget.x, toTarget.y);
  }

  /** [m] that a pixel covers where the camera looks. */
  get metersPerPixel(): number {
    const distance = this.camera.position.distanceTo(this.controls.target);
    return (2 * distance * Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2))) / Math.max(1, this.canvas.clientHeight);
  }

  /** What lies under a pixel of the window: an object of a layer that can be chosen (userData.pick), or the ground. */
  pick(clientX: number, clientY: number): GroundHit | null {
    const frame = this.canvas.getBoundingClientRect();
    const ray = this.rayAt((2 * (clientX - frame.left)) / frame.width - 1, 1 - (2 * (clientY - frame.top)) / frame.height);
    const chosen = this.hitsOf(ray, [...this.layers.values()].filter((layer) => layer.visible)).find(({ object }) => pickable(object));
    const hit = this.hitsOf(ray, this.groundObjects())[0];
    if (chosen && (!hit || chosen.distance < hit.distance + 1)) return { point: chosen.point.toArray(), object: pickable(chosen.object) };
    return hit ? { point: hit.point.toArray(), object: null } : null;
  }

  /** Where the middle of the picture meets the ground. */
  pickMiddle(): Vector | null {
    return this.hitsOf(this.rayAt(0, 0), this.groundObjects())[0]?.point.toArray() ?? null;
  }

  /** The ground's height below a place that lies at about `height` [m]; null where there is none. Of tiles that are loaded. */
  groundBelow(x: number, y: number, height: number): number | null {
    const ray = new THREE.Raycaster(new THREE.Vector3(x, y, height + 1), new THREE.Vector3(0, 0, -1), 0, 4);
    return this.hitsOf(ray, this.groundObjects())[0]?.point.z ?? null;
  }

  /** The height of the highest ground at a place, [m] in site, shown or not; null where there is none. Of tiles that are loaded. */
  groundFromAbove(x: number, y: number): number | null {
    const ray = new THREE.Raycaster(new THREE.Vector3(x, y, this.bounds.max[2] + 1), new THREE.Vector3(0, 0, -1));
    return ray.intersectObjects(this.ground?.shown ?? [])[0]?.point.z ?? null;
  }

  /** Where a point of the site is in the picture, [px] from its upper left corner; null behind the camera. */
  project(point: Vector): [number, number] | null {
    const projected = new THREE.Vector3(...point).project(this.camera);
    if (projected.z > 1) return null;
    return [((projected.x + 1) / 2) * this.canvas.clientWidth, ((1 - projected.y) / 2) * this.canvas.clientHeight];
  }

  /** Returns what ends it. */
  on<Name extends keyof Events>(name: Name, listener: Events[Name]): () => void {
    this.listeners[name].add(listener);
    return () => this.listeners[name].delete(listener);
  }

  requestFrame(): void {
    if (this.frame !== 0) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.camera.updateMatrixWorld();
      this.ground?.update(this.renderer);
      if (this.ground && !this.ground.isThere) return; // nothing to see takes as long to draw as something
      this.renderer.render(this.world, this.camera);
      this.emit('frame');
    });
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.frame = -1; // nothing is drawn any more
    this.observer.disconnect();
    this.controls.dispose();
    this.closeGround();
    for (const layer of this.layers.values()) disposeOf(layer);
    this.renderer.dispose();
  }

  /** One triangle of ground, drawn now, lets the graphics driver compile while the first tile comes what that will need. */
  private warmUp(): void {
    this.sample = this.look.makeSample();
    this.renderer.render(this.sample, this.camera);
  }

  private closeGround(): void {
    if (!this.ground) return;
    this.world.remove(this.ground.group);
    this.ground.dispose();
    this.ground = null;
  }

  private groundObjects(): THREE.Object3D[] {
    return this.ground?.group.visible ? this.ground.shown : [];
  }

  private rayAt(x: number, y: number): THREE.Raycaster {
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(x, y), this.camera);
    ray.params.Line.threshold = 4 * this.metersPerPixel;
    return ray;
  }

  private hitsOf(ray: THREE.Raycaster, objects: THREE.Object3D[]): THREE.Intersection[] {
    return ray
      .intersectObjects(objects)
      .filter(({ point, object }) => point.z >= this.slice.low && point.z <= this.slice.high && isShown(object));
  }

  private lookFrom(direction: THREE.Vector3): void {
    const box = new THREE.Box3(new THREE.Vector3(...this.bounds.min), new THREE.Vector3(...this.bounds.max));
    const center = box.getCenter(new THREE.Vector3());
    const tangent = Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2));
    const [toCamera, right] = [direction.clone().normalize(), new THREE.Vector3(1, 0, 0)];
    const up = toCamera.clone().cross(right);
    // Each corner is as far ahead of the camera as it takes to be in the picture.
    let distance = kNearest;
    for (let i = 0; i < 8; ++i) {
      const corner = new THREE.Vector3(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z).sub(center);
      const across = Math.max(Math.abs(corner.dot(right)) / Math.max(this.camera.aspect, 0.2), Math.abs(corner.dot(up)));
      distance = Math.max(distance, corner.dot(toCamera) + (kMargin * across) / tangent);
    }
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(toCamera, distance);
    this.controls.update();
    this.whole = { direction, position: this.camera.position.clone() };
    this.requestFrame();
  }

  private resize(): void {
    const place = this.canvas.parentElement ?? this.canvas;
    const [width, height] = [Math.max(1, place.clientWidth), Math.max(1, place.clientHeight)];
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    // Whoever looks at everything goes on doing so in a picture of another shape.
    if (this.whole && this.camera.position.distanceTo(this.whole.position) < kStill) this.lookFrom(this.whole.direction);
    this.emit('view');
    this.requestFrame();
  }

  // Scripts that hold the page to its budget ask by this event, and find the answer in it.
  private tellCost({ detail }: CustomEvent<object>): void {
    const { render, memory } = this.renderer.info;
    Object.assign(detail, { frame: render.frame, calls: render.calls, triangles: render.triangles, ...memory });
  }

  // A click is a press that does not move: dragging turns the map.
  private watchPointer(): void {
    let pressed: [number, number] | null = null;
    this.canvas.addEventListener('pointerdown', (event) => {
      pressed = event.button === 0 ? [event.clientX, event.clientY] : null;
    });
    this.canvas.addEventListener('pointerup', (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > kSteady) return;
      const hit = this.pick(event.clientX, event.clientY);
      for (const listener of this.listeners.click) listener(hit, event);
    });
    let isAsked = false;
    this.canvas.addEventListener('pointermove', (event) => {
      if (isAsked || this.listeners.hover.size === 0 || event.buttons !== 0) return;
      isAsked = true;
      const { clientX, clientY } = event;
      requestAnimationFrame(() => {
        isAsked = false;
        const point = this.pick(clientX, clientY)?.point ?? null;
        for (const listener of this.listeners.hover) listener(point);
      });
    });
    this.canvas.addEventListener('pointerleave', () => {
      for (const listener of this.listeners.hover) listener(null);
    });
  }

  private emit(name: 'view' | 'frame'): void {
    for (const listener of this.listeners[name]) listener();
  }
}

/** The object of a layer that a click on one of its parts chooses; null where that is none. */
function pickable(object: THREE.Object3D): THREE.Object3D | null {
  for (let at: THREE.Object3D | null = object; at; at = at.parent) if (at.userData['pick'] !== undefined) return at;
  return null;
}

function isShown(object: THREE.Object3D): boolean {
  for (let at: THREE.Object3D | null = object; at; at = at.parent) if (!at.visible) return false;
  return true;
}

/** Frees what an object and its parts hold on the graphics card. */
export function disposeOf(object: THREE.Object3D): void {
  object.traverse((part) => {
    if (!(part instanceof THREE.Mesh || part instanceof THREE.Line || part instanceof THREE.Points || part instanceof THREE.Sprite)) return;
    part.geometry.dispose();
    for (const material of [part.material].flat() as (THREE.Material & { map?: THREE.Texture | null })[]) {
      material.map?.dispose();
      material.dispose();
    }
  });
}
