// The car and the chosen spot as layers of a scene.

import type * as THREE from 'three';

import type { Vector } from '../api/types';
import type { MapScene } from '../scene/map_scene';
import { makeCar, makeSpotMark, type CarCamera } from './car_model';
import type { CarPose } from './poses';

const kFollowFrom = 22; // [m]

export class CarLayer {
  /** Whether the camera goes where the car goes. */
  private isFollowed = false;
  private car: THREE.Object3D | null = null;
  private at: Vector | null = null;

  constructor(private readonly scene: MapScene) {}

  /** Another car, as it is looked at in other drives. */
  setCar(cameras: readonly CarCamera[], color: number): void {
    this.car = makeCar(cameras, color);
    this.car.visible = false;
    this.at = null;
    this.scene.fillLayer('car', this.car);
  }

  /** Null where nobody knows where it was. */
  setPose(pose: CarPose | null): void {
    if (!this.car) return;
    this.car.visible = pose !== null;
    if (pose) {
      this.car.position.copy(pose.position);
      this.car.quaternion.copy(pose.orientation);
      const next = pose.position.toArray();
      if (this.isFollowed) this.moveCamera(next);
      this.at = next;
    }
    this.scene.requestFrame();
  }

  follow(isFollowed: boolean): void {
    this.isFollowed = isFollowed;
    if (isFollowed && this.at) this.scene.lookAt(this.at, kFollowFrom);
  }

  markSpot(point: Vector | null, color: number): void {
    const mark = point ? [makeSpotMark(color)] : [];
    mark[0]?.position.set(point![0], point![1], point![2] + 0.03);
    this.scene.fillLayer('spot', ...mark);
  }

  dispose(): void {
    this.scene.fillLayer('car');
    this.scene.fillLayer('spot');
  }

  /** The camera keeps its distance and direction. */
  private moveCamera(next: Vector): void {
    if (!this.at) {
      this.scene.lookAt(next, kFollowFrom);
      return;
    }
    const moved = next.map((value, axis) => value - this.at![axis]!);
    const { position, target } = this.scene.view;
    const shifted = (point: Vector) => point.map((value, axis) => value + moved[axis]!) as Vector;
    this.scene.view = { position: shifted(position), target: shifted(target) };
  }
}
