// Measurements in the scene: the line or the outline, its points, and what it measures written beside it.

import * as THREE from 'three';

import type { Vector } from '../api/types';
import { fatLines, segmentsOf, unpickable } from '../scene/layers/fat_lines';
import { centerOf, type Kind } from './geometry';

export interface Drawing {
  kind: Kind;
  points: Vector[];
  text: string; // empty: nothing is written
}

const kColor = 0xffd166;
const kInk = 0x0b1220;
const kLift = 0.02; // [m] above the ground that the points lie on
const kOrder = 50; // above the map's layers: ink, then color, then text

export function makeDrawing({ kind, points, text }: Drawing): THREE.Object3D[] {
  if (points.length === 0) return [];
  const lifted = points.map(([x, y, z]) => [x, y, z + kLift] as Vector);
  const path = kind === 'height' ? stairOf(lifted) : kind === 'area' && lifted.length > 2 ? [...lifted, lifted[0]!] : lifted;
  const objects: THREE.Object3D[] = [makeDots(lifted, 13, kInk, kOrder + 2), makeDots(lifted, 9, kColor, kOrder + 3)];
  if (path.length > 1) objects.push(makeLine(path, 6, kInk, kOrder), makeLine(path, 3, kColor, kOrder + 1));
  if (text !== '') objects.push(kind === 'area' ? makeText(text, centerOf(lifted), 0.5) : makeText(text, middleOf(path), -0.6));
  return objects;
}

/** A mark where a point would be added. */
export const makeCandidate = (point: Vector): THREE.Object3D[] => [makeDots([point], 15, kInk, kOrder + 2), makeDots([point], 5, kColor, kOrder + 3)];

/** Along, and then up or down. */
function stairOf(points: Vector[]): Vector[] {
  const [from, to] = points;
  return from && to ? [from, [to[0], to[1], from[2]], to] : points;
}

function middleOf(path: Vector[]): Vector {
  const leg = Math.floor((path.length - 1) / 2);
  const [from, to] = [path[leg]!, path[Math.min(leg + 1, path.length - 1)]!];
  return from.map((value, axis) => (value + to[axis]!) / 2) as Vector;
}

function makeLine(path: Vector[], width: number, color: number, order: number): THREE.Object3D {
  const line = fatLines(segmentsOf(path), { width, color, order });
  line.material.depthTest = false;
  return line;
}

function makeDots(points: Vector[], size: number, color: number, renderOrder: number): THREE.Points {
  const geometry = new THREE.BufferGeometry().setAttribute('position', new THREE.Float32BufferAttribute(points.flat(), 3));
  const material = new THREE.PointsMaterial({ color, size: size * devicePixelRatio, sizeAttenuation: false, depthTest: false, transparent: true });
  const dots = unpickable(new THREE.Points(geometry, material));
  dots.renderOrder = renderOrder;
  return dots;
}

const kTextPixels = 48; // of the texture's height
const kTextSize = 0.034; // of the picture's height

/** `anchor`: the share of its height, from below, that lies at the point. */
function makeText(text: string, point: Vector, anchor: number): THREE.Sprite {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d')!;
  const font = '600 28px system-ui, sans-serif';
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 28;
  canvas.height = kTextPixels;
  context.fillStyle = '#0b1220e6';
  context.beginPath();
  context.roundRect(0, 0, canvas.width, canvas.height, 12);
  context.fill();
  context.font = font; // a canvas forgets it when its size is set
  context.fillStyle = '#ffffff';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillText(text, canvas.width / 2, canvas.height / 2 + 1);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  const sprite = unpickable(new THREE.Sprite(new THREE.SpriteMaterial({ map, depthTest: false, sizeAttenuation: false })));
  sprite.position.set(...point);
  sprite.center.set(0.5, anchor);
  sprite.scale.set((kTextSize * canvas.width) / canvas.height, kTextSize, 1);
  sprite.renderOrder = kOrder + 4;
  return sprite;
}
