// The decoder of compressed meshes, one for all scenes of the page.

import { DRACO_GLTF_CONFIG, DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';

const kMostWorkers = 4;

// A mesh without faces, points and attributes: "DRACO", version 2.2, a mesh, in sequence, no flags; then four numbers.
const kNothing = [0x44, 0x52, 0x41, 0x43, 0x4f, 2, 2, 1, 0, 0, 0, 0, 0, 1, 0];

let shared: DRACOLoader | null = null;

/** Its first worker starts with the first call, so that it is there when the first tile comes. */
export function dracoDecoder(): DRACOLoader {
  if (shared) return shared;
  shared = new DRACOLoader();
  shared.setDecoderPath(DRACO_GLTF_CONFIG); // bundled with the page: no CDN
  shared.setWorkerLimit(Math.min(navigator.hardwareConcurrency || kMostWorkers, kMostWorkers));
  shared.parse(new Uint8Array(kNothing).buffer, () => undefined);
  return shared;
}
