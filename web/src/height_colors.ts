import * as THREE from 'three';

// Dark blue, teal, green, yellow: even in lightness, readable without red-green vision.
const kRamp = [0x29307c, 0x1f7a8c, 0x3fb68b, 0xf6e05e].map((hex) => new THREE.Color(hex));

/** One color per vertex by its height (glTF's y), lowest to highest vertex. */
export function colorsByHeight(geometry: THREE.BufferGeometry): THREE.BufferAttribute {
  const position = geometry.getAttribute('position');
  let lowest = Infinity;
  let highest = -Infinity;
  for (let i = 0; i < position.count; ++i) {
    lowest = Math.min(lowest, position.getY(i));
    highest = Math.max(highest, position.getY(i));
  }
  const range = Math.max(highest - lowest, 0.05); // a flat lot is one color, not noise
  const colors = new Float32Array(3 * position.count);
  for (let i = 0; i < position.count; ++i) rampColor((position.getY(i) - lowest) / range).toArray(colors, 3 * i);
  return new THREE.BufferAttribute(colors, 3);
}

/** Color at `fraction` in [0, 1]. */
export function rampColor(fraction: number): THREE.Color {
  const place = Math.min(Math.max(fraction, 0), 1) * (kRamp.length - 1);
  const index = Math.min(Math.floor(place), kRamp.length - 2);
  return kRamp[index]!.clone().lerp(kRamp[index + 1]!, place - index);
}
