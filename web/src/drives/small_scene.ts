// A small picture in three dimensions that can be turned: z up, drawn when something changed.

import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

export class SmallScene {
  readonly world = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(40, 1, 0.05, 5000);
  protected readonly renderer: THREE.WebGLRenderer;
  protected readonly controls: OrbitControls;
  private readonly observer: ResizeObserver;
  private frame = 0;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera.up.set(0, 0, 1);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8d99a8, 3));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.requestFrame());
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas.parentElement ?? canvas);
    this.resize();
  }

  requestFrame(): void {
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.world, this.camera);
    });
  }

  /** Everything in view, from `direction`; nearer by `share` than its corners would take. */
  lookAtAll(box: THREE.Box3, direction: THREE.Vector3, share = 1): void {
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    const distance = (1.05 * share * sphere.radius) / Math.sin(THREE.MathUtils.degToRad(this.camera.fov / 2));
    this.controls.target.copy(sphere.center);
    this.camera.position.copy(sphere.center).addScaledVector(direction.clone().normalize(), distance);
    this.controls.update();
    this.requestFrame();
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.observer.disconnect();
    this.controls.dispose();
    disposeOf(this.world);
    this.renderer.dispose();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement ?? this.canvas;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    this.requestFrame();
  }
}

export function disposeOf(root: THREE.Object3D): void {
  root.traverse((object) => {
    if (!(object instanceof THREE.Mesh || object instanceof THREE.Line || object instanceof THREE.Points)) return;
    (object.geometry as THREE.BufferGeometry).dispose();
    for (const material of [object.material as THREE.Material | THREE.Material[]].flat()) {
      for (const value of Object.values(material)) if (value instanceof THREE.Texture) value.dispose();
      material.dispose();
    }
  });
}
