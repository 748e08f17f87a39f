// How the ground is colored: by its pictures, or by a number that each spot has. One ramp for the whole site,
// whatever tile a spot lies in.

import * as THREE from 'three';

/** Dark blue, teal, green, yellow: even in lightness, readable without red-green vision. */
export const kRamp: readonly number[] = [0x29307c, 0x1f7a8c, 0x3fb68b, 0xf6e05e];
/** Blue, white, red: below, as it was, above. */
export const kDiverging: readonly number[] = [0x2166ac, 0xf2f2f0, 0xb2182b];
/** One for each drive, in turn. */
export const kPalette: readonly number[] = [0x39a0ff, 0xffb020, 0x57c77f, 0xff6b8b, 0xb48cff, 0x2fc4c4, 0xd98a5b, 0xc7d14a];

export type GroundColors =
  | { by: 'picture' }
  | { by: 'height'; low: number; high: number } // [m] in site
  | { by: 'slope'; high: number } // rise per run
  /** A number of each vertex, from its place; NaN: unknown, gray. */
  | { by: 'value'; low: number; high: number; colors: readonly number[]; isPalette?: boolean; valueAt: (x: number, y: number, z: number) => number };

const kModes = { picture: 0, height: 1, slope: 2, value: 3 };
const kMaxColors = 8;

/** Shared by the materials of all tiles. */
export class GroundLook {
  colors: GroundColors = { by: 'picture' };
  private readonly uniforms = {
    groundMode: { value: 0 },
    groundRange: { value: new THREE.Vector2(0, 1) },
    groundColors: { value: Array.from({ length: kMaxColors }, () => new THREE.Color()) },
    groundNumColors: { value: 0 },
    groundIsPalette: { value: false },
  };

  set(colors: GroundColors): void {
    this.colors = colors;
    this.uniforms.groundMode.value = kModes[colors.by];
    const low = 'low' in colors ? colors.low : 0;
    this.uniforms.groundRange.value.set(low, 'high' in colors ? Math.max(colors.high, low + 1e-6) : low + 1);
    const shown = colors.by === 'value' ? colors.colors : kRamp;
    shown.slice(0, kMaxColors).forEach((hex, i) => this.uniforms.groundColors.value[i]!.setHex(hex));
    this.uniforms.groundNumColors.value = Math.min(shown.length, kMaxColors);
    this.uniforms.groundIsPalette.value = colors.by === 'value' && colors.isPalette === true;
  }

  /** Gives a mesh of the ground its look. `siteFromMesh` places its vertices. */
  apply(mesh: THREE.Mesh, siteFromMesh: THREE.Matrix4): void {
    const made = mesh.material as THREE.MeshBasicMaterial | THREE.MeshStandardMaterial;
    const material = new THREE.MeshBasicMaterial({
      map: made.map,
      vertexColors: mesh.geometry.hasAttribute('color'),
      side: THREE.DoubleSide,
    });
    material.onBeforeCompile = (shader) => this.patch(shader);
    material.customProgramCacheKey = () => 'parkade-ground';
    made.dispose();
    mesh.material = material;
    this.fillValues(mesh, siteFromMesh);
  }

  /** A speck of ground, as tiles have it. */
  makeSample(): THREE.Mesh {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(9), 3));
    geometry.setAttribute('uv', new THREE.BufferAttribute(new Float32Array(6), 2));
    const map = new THREE.DataTexture(new Uint8Array(4), 1, 1);
    map.colorSpace = THREE.SRGBColorSpace;
    map.generateMipmaps = true;
    map.minFilter = THREE.LinearMipmapLinearFilter;
    map.needsUpdate = true;
    const sample = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map }));
    sample.frustumCulled = false;
    this.apply(sample, new THREE.Matrix4());
    return sample;
  }

  /** The number of each vertex, where the ground is colored by one. */
  fillValues(mesh: THREE.Mesh, siteFromMesh: THREE.Matrix4): void {
    const position = mesh.geometry.getAttribute('position');
    const values = new Float32Array(position.count);
    if (this.colors.by === 'value') {
      const point = new THREE.Vector3();
      for (let i = 0; i < position.count; ++i) {
        point.fromBufferAttribute(position, i).applyMatrix4(siteFromMesh);
        const value = this.colors.valueAt(point.x, point.y, point.z);
        values[i] = Number.isNaN(value) ? kUnknown : value;
      }
    }
    mesh.geometry.setAttribute('groundValue', new THREE.BufferAttribute(values, 1));
  }

  private patch(shader: THREE.WebGLProgramParametersWithUniforms): void {
    Object.assign(shader.uniforms, this.uniforms);
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute float groundValue;\nvarying float vGroundValue;\nvarying vec3 vGroundPoint;')
      .replace(
        '#include <begin_vertex>',
        '#include <begin_vertex>\nvGroundValue = groundValue;\nvGroundPoint = (modelMatrix * vec4(position, 1.0)).xyz;',
      );
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>\n${kFragment}`)
      .replace('#include <color_fragment>', '#include <color_fragment>\ndiffuseColor.rgb = groundColor(diffuseColor.rgb);');
  }
}

const kUnknown = -1e30;

const kFragment = /* glsl */ `
  uniform int groundMode;
  uniform vec2 groundRange;
  uniform vec3 groundColors[${kMaxColors}];
  uniform int groundNumColors;
  uniform bool groundIsPalette;
  varying float vGroundValue;
  varying vec3 vGroundPoint;

  vec3 rampAt(float share) {
    float place = clamp(share, 0.0, 1.0) * float(groundNumColors - 1);
    int first = min(int(floor(place)), groundNumColors - 2);
    return mix(groundColors[first], groundColors[first + 1], place - float(first));
  }

  vec3 groundColor(vec3 picture) {
    vec3 shown = picture;
    if (groundMode == ${kModes.height}) {
      shown = rampAt((vGroundPoint.z - groundRange.x) / (groundRange.y - groundRange.x));
    } else if (groundMode == ${kModes.slope}) {
      vec3 normal = cross(dFdx(vGroundPoint), dFdy(vGroundPoint));
      shown = rampAt(length(normal.xy) / max(abs(normal.z), 1e-9) / groundRange.y);
    } else if (groundMode == ${kModes.value}) {
      if (vGroundValue < -1e29) shown = vec3(0.35);
      else if (groundIsPalette) shown = groundColors[int(mod(vGroundValue + 0.5, float(groundNumColors)))] * (0.35 + 0.65 * dot(picture, vec3(0.3, 0.6, 0.1)));
      else shown = rampAt((vGroundValue - groundRange.x) / (groundRange.y - groundRange.x));
    }
    return shown;
  }
`;

/** The color of a ramp at a share in [0, 1], as the shader draws it. */
export function rampColor(share: number, colors: readonly number[] = kRamp): THREE.Color {
  const place = Math.min(Math.max(share, 0), 1) * (colors.length - 1);
  const first = Math.min(Math.floor(place), colors.length - 2);
  return new THREE.Color(colors[first]).lerp(new THREE.Color(colors[first + 1]), place - first);
}
