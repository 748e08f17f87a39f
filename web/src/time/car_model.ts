// The car in the scene: a body on its wheels, with what its cameras look at. The body's frame: x ahead, y to the left,
// z up, from the middle of the rear axle on the ground.

import * as THREE from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

import type { Pose } from '../api/types';

export interface CarCamera {
  bodyFromCamera: Pose;
  color: number;
  aspect: number;
}

const kWheelbase = 2.6, kTrack = 1.56, kWheel = { radius: 0.32, width: 0.22 }; // [m]
const kUsual = { front: 3.45, rear: -0.85, halfWidth: 0.9 }; // [m]
const kGlass = 0x1b2430, kTire = 0x20252c;

/** How far the car reaches, so that no camera hangs in the air before it. */
function extentOf(cameras: readonly CarCamera[]): typeof kUsual {
  const xs = cameras.map(({ bodyFromCamera: { position } }) => position[0]);
  const ys = cameras.map(({ bodyFromCamera: { position } }) => Math.abs(position[1]));
  return {
    front: Math.max(kUsual.front, ...xs),
    rear: Math.min(kUsual.rear, ...xs),
    halfWidth: Math.min(1.05, Math.max(kUsual.halfWidth, ...ys.map((y) => y - 0.06))),
  };
}

function colored(geometry: THREE.BufferGeometry, color: number): THREE.BufferGeometry {
  const flat = geometry.index ? geometry.toNonIndexed() : geometry;
  const { r, g, b } = new THREE.Color(color);
  const count = flat.getAttribute('position').count;
  flat.setAttribute('color', new THREE.BufferAttribute(new Float32Array(count * 3).map((_, i) => [r, g, b][i % 3]!), 3));
  return flat;
}

/** A side view, [m] ahead and up, as a body of a width with softened edges. */
function extruded(outline: readonly (readonly [number, number])[], halfWidth: number, color: number): THREE.BufferGeometry {
  const soft = 0.07;
  const shape = new THREE.Shape(outline.map(([x, z]) => new THREE.Vector2(x, z)));
  const depth = 2 * (halfWidth - soft);
  const geometry = new THREE.ExtrudeGeometry(shape, {
    depth, bevelEnabled: true, bevelSize: 0.05, bevelThickness: soft, bevelSegments: 2, curveSegments: 1,
  });
  geometry.rotateX(Math.PI / 2).translate(0, depth / 2, 0);
  return colored(geometry, color);
}

function bodyOf(cameras: readonly CarCamera[], color: number): THREE.Mesh {
  const { front, rear, halfWidth } = extentOf(cameras);
  const lower = extruded(
    [[rear + 0.05, 0.32], [rear + 0.1, 0.88], [rear + 0.35, 0.98], [2.25, 0.98], [front - 0.35, 0.82], [front - 0.06, 0.66], [front - 0.05, 0.3]],
    halfWidth, color,
  );
  const cabin = extruded([[rear + 0.3, 0.98], [rear + 0.75, 1.36], [1.2, 1.36], [2.1, 0.98]], halfWidth - 0.12, kGlass);
  const roof = extruded([[rear + 0.72, 1.38], [rear + 0.85, 1.42], [1.1, 1.42], [1.2, 1.38]], halfWidth - 0.14, color);
  const wheels = [0, kWheelbase].flatMap((x) =>
    [-1, 1].map((side) =>
      colored(
        new THREE.CylinderGeometry(kWheel.radius, kWheel.radius, kWheel.width, 20).translate(x, (side * kTrack) / 2 + side * 0.06, kWheel.radius),
        kTire,
      ),
    ),
  );
  const geometry = mergeGeometries([lower, cabin, roof, ...wheels]);
  return new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ vertexColors: true, flatShading: true }));
}

const kReach = 1.1; // [m] of a frustum

/** What the cameras look at, as frusta: their lenses see more, which would hide the car. */
function frustaOf(cameras: readonly CarCamera[]): THREE.LineSegments {
  const points: number[] = [];
  const colors: number[] = [];
  for (const { bodyFromCamera, color, aspect } of cameras) {
    const place = new THREE.Vector3(...bodyFromCamera.position);
    const turn = new THREE.Quaternion(...bodyFromCamera.orientation);
    const corner = (right: number, down: number) =>
      new THREE.Vector3(right * 0.62 * kReach, (down * 0.62 * kReach) / aspect, kReach).applyQuaternion(turn).add(place);
    const [a, b, c, d] = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
    const up = corner(0, -1.35); // which side of the picture is up
    const lines = [place, a, place, b, place, c, place, d, a, b, b, c, c, d, d, a, a, up, up, b];
    const { r, g, b: blue } = new THREE.Color(color);
    for (const point of lines) {
      points.push(...point.toArray());
      colors.push(r, g, blue);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(colors, 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true }));
}

/** Two things to draw: the body with its wheels, and the frusta. */
export function makeCar(cameras: readonly CarCamera[], color: number): THREE.Group {
  const car = new THREE.Group();
  car.add(bodyOf(cameras, color));
  if (cameras.length > 0) car.add(frustaOf(cameras));
  return car;
}

/** A ring about a spot of the map with a pin in it, seen through what lies before it. */
export function makeSpotMark(color: number): THREE.Group {
  const mark = new THREE.Group();
  const material = new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true, side: THREE.DoubleSide });
  const ring = new THREE.RingGeometry(0.34, 0.46, 40);
  const dot = new THREE.CircleGeometry(0.1, 20);
  const pin = new THREE.CylinderGeometry(0.02, 0.02, 1.4, 8).rotateX(Math.PI / 2).translate(0, 0, 0.7);
  const mesh = new THREE.Mesh(mergeGeometries([ring, dot, pin]), material);
  mesh.renderOrder = 10;
  mark.add(mesh);
  return mark;
}
