// The cameras of a rig on their car: what each sees of the ground about it, in its own color.

import * as THREE from 'three';

import { applied, type RigCamera, type RigShape } from './rig_geometry';
import { SmallScene } from './small_scene';

export const kCameraColors = [0x3b82f6, 0xf59e0b, 0x10b981, 0xec4899, 0x8b5cf6, 0x06b6d4, 0xef4444, 0x84cc16];

const kReach = 1.1; // [m] length of a frustum
const kWidest = THREE.MathUtils.degToRad(80); // of half a frustum: a flat pyramid cannot show more
const kSteps = 12; // along each edge
const kWheelRadius = 0.32; // [m]
const kOverhang = { front: 0.85, back: 0.75, side: 0.17 }; // [m] of a common car beyond its wheels

export class RigScene extends SmallScene {
  show(rig: RigShape): void {
    const wheelbase = rig.wheelbase ?? 2.7;
    const track = rig.track ?? 1.55;
    // body is at the rear axle; where it is on the ground, wheels stand on z = 0.
    this.world.add(car(wheelbase, track), ground());
    rig.cameras.forEach((camera, i) => this.world.add(frustum(camera, kCameraColors[i % kCameraColors.length]!)));
    this.world.add(axes(rig.imu));
    if (rig.gnss) this.world.add(antenna(rig.gnss));
    const box = new THREE.Box3(new THREE.Vector3(-1.6, -1.8, 0), new THREE.Vector3(wheelbase + 1.8, 1.8, 1.4));
    for (const { pose } of rig.cameras) box.expandByPoint(new THREE.Vector3(...pose.translation));
    this.lookAtAll(box, new THREE.Vector3(0.75, 0.95, 0.75), 0.72);
  }
}

/** A plain body on four wheels. */
function car(wheelbase: number, track: number): THREE.Group {
  const group = new THREE.Group();
  const length = wheelbase + kOverhang.front + kOverhang.back;
  const width = track + 2 * kOverhang.side;
  const paint = new THREE.MeshLambertMaterial({ color: 0x94a3b8, transparent: true, opacity: 0.55, depthWrite: false });
  const glass = new THREE.MeshLambertMaterial({ color: 0x475569, transparent: true, opacity: 0.5, depthWrite: false });
  const side = new THREE.Shape([
    new THREE.Vector2(-kOverhang.back, 0.3),
    new THREE.Vector2(length - kOverhang.back, 0.3),
    new THREE.Vector2(length - kOverhang.back, 0.7),
    new THREE.Vector2(wheelbase + 0.15, 0.92),
    new THREE.Vector2(-kOverhang.back, 0.98),
  ]);
  const cabin = new THREE.Shape([
    new THREE.Vector2(-kOverhang.back + 0.15, 0.97),
    new THREE.Vector2(wheelbase - 0.05, 0.93),
    new THREE.Vector2(wheelbase - 0.85, 1.45),
    new THREE.Vector2(0.05, 1.47),
  ]);
  for (const [shape, across, material] of [[side, width, paint], [cabin, width - 0.3, glass]] as const) {
    const geometry = new THREE.ExtrudeGeometry(shape, { depth: across, bevelEnabled: false });
    geometry.translate(0, 0, -across / 2).rotateX(Math.PI / 2); // drawn in x and z, thick along y
    group.add(new THREE.Mesh(geometry, material));
    group.add(new THREE.LineSegments(new THREE.EdgesGeometry(geometry), new THREE.LineBasicMaterial({ color: 0x64748b })));
  }
  const wheel = new THREE.InstancedMesh(new THREE.CylinderGeometry(kWheelRadius, kWheelRadius, 0.2, 28), new THREE.MeshLambertMaterial({ color: 0x1e293b }), 4);
  [[0, 1], [0, -1], [1, 1], [1, -1]].forEach(([along, across], i) =>
    wheel.setMatrixAt(i, new THREE.Matrix4().makeTranslation(along! * wheelbase, (across! * track) / 2, kWheelRadius)),
  );
  group.add(wheel);
  return group;
}

function ground(): THREE.Object3D {
  const grid = new THREE.GridHelper(12, 12, 0x8392a6, 0x8392a6);
  grid.rotation.x = Math.PI / 2;
  grid.position.set(1, 0, 0);
  (grid.material as THREE.Material).transparent = true;
  (grid.material as THREE.Material).opacity = 0.3;
  return grid;
}

/** The edge of what a camera sees at a distance, joined with its center; curved, for fisheyes see a bowl. */
function frustum(camera: RigCamera, color: number): THREE.Group {
  const rim = rimOf(camera).map((ray) => new THREE.Vector3(...applied(camera.pose, ray)));
  const center = new THREE.Vector3(...camera.pose.translation);
  const lines: THREE.Vector3[] = [];
  rim.forEach((point, i) => {
    lines.push(point, rim[(i + 1) % rim.length]!);
    if (i % kSteps === 0) lines.push(center, point);
  });
  const sides = rim.flatMap((point, i) => [center, point, rim[(i + 1) % rim.length]!]);
  const group = new THREE.Group();
  group.add(
    new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(lines), new THREE.LineBasicMaterial({ color })),
    new THREE.Mesh(
      new THREE.BufferGeometry().setFromPoints(sides),
      new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.18, side: THREE.DoubleSide, depthWrite: false }),
    ),
    new THREE.Mesh(new THREE.SphereGeometry(0.055, 16, 12).translate(center.x, center.y, center.z), new THREE.MeshBasicMaterial({ color })),
  );
  return group;
}

/** Rays around the image, in the camera's frame (z ahead, y down), of the frustum's length. */
function rimOf({ halfWidth, halfHeight }: RigCamera): [number, number, number][] {
  const corners: [number, number][] = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
  return corners.flatMap(([u, v], i) => {
    const [u2, v2] = corners[(i + 1) % 4]!;
    return Array.from({ length: kSteps }, (_, step) => {
      const part = step / kSteps;
      const [x, y] = [(u + (u2 - u) * part) * halfWidth, (v + (v2 - v) * part) * halfHeight];
      const angle = Math.min(Math.hypot(x, y), kWidest);
      const around = Math.atan2(y, x);
      const across = Math.sin(angle) * kReach;
      return [across * Math.cos(around), across * Math.sin(around), Math.cos(angle) * kReach] as [number, number, number];
    });
  });
}

function axes([x, y, z]: [number, number, number]): THREE.Object3D {
  const helper = new THREE.AxesHelper(0.35);
  helper.position.set(x, y, z);
  return helper;
}

function antenna([x, y, z]: [number, number, number]): THREE.Object3D {
  return new THREE.Mesh(new THREE.ConeGeometry(0.06, 0.12, 16).rotateX(Math.PI / 2).translate(x, y, z), new THREE.MeshBasicMaterial({ color: 0x334155 }));
}
