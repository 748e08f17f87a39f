// The preview of a map that is made: replaced by the next one without moving the camera.

import * as THREE from 'three';
import { DRACO_GLTF_CONFIG, DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

import { disposeOf, SmallScene } from './small_scene';

export class PreviewScene extends SmallScene {
  private readonly draco = new DRACOLoader().setDecoderPath(DRACO_GLTF_CONFIG);
  private shown: THREE.Object3D | null = null;

  async show(address: string): Promise<void> {
    const { scene } = await new GLTFLoader().setDRACOLoader(this.draco).loadAsync(address);
    scene.rotation.x = Math.PI / 2; // glTF is y up
    scene.traverse((object) => {
      if (object instanceof THREE.Mesh) object.material = unlit(object.material as THREE.Material);
    });
    const isFirst = this.shown === null;
    if (this.shown) {
      this.world.remove(this.shown);
      disposeOf(this.shown);
    }
    this.shown = scene;
    this.world.add(scene);
    if (isFirst) this.lookAtAll(new THREE.Box3().setFromObject(scene), new THREE.Vector3(0, -0.8, 1), 0.75);
    this.requestFrame();
  }

  override dispose(): void {
    super.dispose();
    this.draco.dispose();
  }
}

/** Textures hold the light of the day they were taken. */
function unlit(material: THREE.Material): THREE.Material {
  if (!(material instanceof THREE.MeshStandardMaterial)) return material;
  const { map, color, vertexColors } = material;
  material.dispose();
  return new THREE.MeshBasicMaterial({ map, color, vertexColors, side: THREE.DoubleSide });
}
