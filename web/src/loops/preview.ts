// What a version will look like, in the place of the version that is shown.

import { Group } from 'three';
import { DRACO_GLTF_CONFIG, DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

import { disposeOf, type MapScene } from '../scene/map_scene';

const kLayer = 'loop_preview';

/** `isWanted` is asked once it is loaded: another may have come meanwhile. */
export async function showPreview(scene: MapScene, address: string, isWanted: () => boolean): Promise<void> {
  const draco = new DRACOLoader();
  draco.setDecoderPath(DRACO_GLTF_CONFIG);
  try {
    const { scene: ground } = await new GLTFLoader().setDRACOLoader(draco).loadAsync(address);
    if (!isWanted()) {
      disposeOf(ground);
      return;
    }
    const upright = new Group(); // glTF's y is up
    upright.rotation.x = Math.PI / 2;
    upright.add(ground);
    scene.fillLayer(kLayer, upright);
    scene.setGroundVisible(false);
  } finally {
    draco.dispose();
  }
}

export function hidePreview(scene: MapScene): void {
  scene.fillLayer(kLayer);
  scene.setGroundVisible(true);
}
