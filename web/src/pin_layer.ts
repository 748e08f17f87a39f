import * as THREE from 'three';

import type { Vector } from './api';
import { gltfFromSite } from './pins';

export interface PinMark {
  point: Vector; // [m] in site
  label: string;
  isNew: boolean;
}

const kPixels = 64;
const kSize = 0.045; // of the picture's height, however far away

/** A drop with a label, its tip on the ground. */
function drawMark({ label, isNew }: PinMark): THREE.CanvasTexture {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = kPixels;
  const context = canvas.getContext('2d')!;
  const middle = kPixels / 2;
  context.beginPath();
  context.arc(middle, 25, 21, 0.8 * Math.PI, 2.2 * Math.PI);
  context.lineTo(middle, kPixels - 1);
  context.closePath();
  context.fillStyle = isNew ? '#ffd166' : '#5b93ff';
  context.fill();
  context.lineWidth = 3;
  context.strokeStyle = '#0b1220';
  context.stroke();
  context.fillStyle = '#0b1220';
  context.font = '700 24px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillText(label, middle, 27);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

export function makePinLayer(marks: PinMark[]): THREE.Group {
  const layer = new THREE.Group();
  layer.name = 'pins';
  for (const mark of marks) {
    const material = new THREE.SpriteMaterial({ map: drawMark(mark), depthTest: false, sizeAttenuation: false });
    const sprite = new THREE.Sprite(material);
    sprite.position.set(...gltfFromSite(mark.point));
    sprite.center.set(0.5, 0); // the tip
    sprite.scale.setScalar(kSize);
    sprite.renderOrder = 3;
    layer.add(sprite);
  }
  return layer;
}
