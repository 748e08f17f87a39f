// Markers in the scene: drops with a label, as large on the screen however far away, their tips on the ground.

import * as THREE from 'three';

import type { Vector } from '../api/types';

export interface Marker {
  point: Vector; // [m] in site
  label: string;
  color: keyof typeof kColors;
  isChosen?: boolean;
  /** What a click on it chooses. */
  pick?: object;
}

/** They stand on pictures of asphalt and paint, in both themes. */
const kColors = { known: '#5b93ff', new: '#ffd166', open: '#ffb020', done: '#9fb0c4' };
const kInk = '#0b1220';
const kPixels = 64;
const kSize = 0.045; // of the picture's height
const kChosenSize = 0.06;
const kOrder = 60; // above all layers

function draw({ label, color, isChosen = false }: Marker): THREE.CanvasTexture {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = kPixels;
  const context = canvas.getContext('2d')!;
  const middle = kPixels / 2;
  context.beginPath();
  context.arc(middle, 25, 21, 0.8 * Math.PI, 2.2 * Math.PI);
  context.lineTo(middle, kPixels - 3);
  context.closePath();
  context.fillStyle = isChosen ? '#ffffff' : kColors[color];
  context.fill();
  context.lineWidth = isChosen ? 5 : 3;
  context.strokeStyle = kInk;
  context.stroke();
  context.fillStyle = kInk;
  context.font = `700 ${label.length > 2 ? 18 : 24}px system-ui, sans-serif`;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillText(label, middle, 27);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

export function makeMarkers(markers: Marker[]): THREE.Sprite[] {
  return markers.map((marker) => {
    const material = new THREE.SpriteMaterial({ map: draw(marker), depthTest: false, sizeAttenuation: false });
    const sprite = new THREE.Sprite(material);
    sprite.position.set(...marker.point);
    sprite.center.set(0.5, 0); // the tip
    sprite.scale.setScalar(marker.isChosen ? kChosenSize : kSize);
    sprite.renderOrder = marker.isChosen ? kOrder + 1 : kOrder;
    if (marker.pick) sprite.userData['pick'] = marker.pick;
    return sprite;
  });
}
