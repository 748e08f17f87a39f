// By how much the later ground lies above the earlier one, at spots close enough together that nothing between is missed.

import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Vector3, type Matrix4 } from 'three';
import { MeshBVH } from 'three-mesh-bvh';

import { kDiverging, rampColor } from '../scene/ground_look';

const kStep = 0.3; // [m] between spots
const kMaxTriangles = 700_000;
const kReach = 1.5; // [m] up and down: the next deck is no change of this one
const kSlice = 12; // [ms] after which the page gets its turn

/**
 * The same surface, with no edge longer than `step`; coarser where that would be too much to draw. An edge is halved in both of
 * its triangles or in neither, so that no gaps open between them.
 */
export function refined(positions: ArrayLike<number>, index: ArrayLike<number>, step = kStep, maxTriangles = kMaxTriangles): { positions: Float32Array; index: Uint32Array } {
  const points = Array.from(positions);
  let triangles = Array.from(index);
  const lengthOf = (a: number, b: number) =>
    Math.hypot(points[3 * a]! - points[3 * b]!, points[3 * a + 1]! - points[3 * b + 1]!, points[3 * a + 2]! - points[3 * b + 2]!);
  for (;;) {
    const middles = new Map<number, number>(); // by edge; fewer than 2^26 points
    const before = points.length;
    const middleOf = (a: number, b: number): number => {
      if (lengthOf(a, b) <= step) return -1;
      const edge = Math.min(a, b) * 2 ** 26 + Math.max(a, b);
      let middle = middles.get(edge);
      if (middle === undefined) {
        middle = points.length / 3;
        for (let axis = 0; axis < 3; ++axis) points.push((points[3 * a + axis]! + points[3 * b + axis]!) / 2);
        middles.set(edge, middle);
      }
      return middle;
    };
    const next: number[] = [];
    for (let t = 0; t < triangles.length; t += 3) {
      const corners = [triangles[t]!, triangles[t + 1]!, triangles[t + 2]!] as const;
      const halves = [middleOf(corners[0], corners[1]), middleOf(corners[1], corners[2]), middleOf(corners[2], corners[0])] as const;
      split(corners, halves, next);
    }
    if (points.length === before || next.length / 3 > maxTriangles) {
      points.length = before;
      return { positions: new Float32Array(points), index: new Uint32Array(triangles) };
    }
    triangles = next;
  }
}

type Three = readonly [number, number, number];

/** The parts of a triangle, some of whose edges are halved: halves[i] lies behind corner i; -1: not halved. */
function split(corners: Three, halves: Three, out: number[]): void {
  const numHalves = halves.filter((half) => half >= 0).length;
  // Turned so that the edge of the one half is the first, or the edge without one the last.
  const turn = numHalves === 1 ? halves.findIndex((half) => half >= 0) : numHalves === 2 ? (halves.indexOf(-1) + 1) % 3 : 0;
  const [a, b, c] = [corners[turn]!, corners[(turn + 1) % 3]!, corners[(turn + 2) % 3]!];
  const [ab, bc, ca] = [halves[turn]!, halves[(turn + 1) % 3]!, halves[(turn + 2) % 3]!];
  if (numHalves === 0) out.push(a, b, c);
  else if (numHalves === 1) out.push(a, ab, c, ab, b, c);
  else if (numHalves === 2) out.push(ab, b, bc, a, ab, bc, a, bc, c);
  else out.push(a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca);
}

/** Looks heights up in the earlier ground, at places of the later site. */
export class EarlierHeights {
  private readonly bvh: MeshBVH;
  private readonly earlierFromLater: Matrix4;
  private readonly ray = new Ray(new Vector3(), new Vector3(0, 0, -1));

  constructor(earlier: BufferGeometry, laterFromEarlier: Matrix4) {
    this.bvh = new MeshBVH(earlier);
    this.earlierFromLater = laterFromEarlier.clone().invert();
  }

  /** [m] by which a point lies above the earlier ground; NaN where that has none. */
  above(x: number, y: number, z: number): number {
    const { origin } = this.ray;
    origin.set(x, y, z).applyMatrix4(this.earlierFromLater);
    const height = origin.z;
    origin.z += kReach;
    let nearest = NaN;
    for (const { point } of this.bvh.raycast(this.ray, DoubleSide, 0, 2 * kReach)) {
      const difference = height - point.z;
      if (Number.isNaN(nearest) || Math.abs(difference) < Math.abs(nearest)) nearest = difference;
    }
    return nearest;
  }
}

/** The later ground, with the attribute `difference` [m]. The page goes on meanwhile; null once it is not wanted any more. */
export async function differenceOf(later: BufferGeometry, earlier: EarlierHeights, isWanted: () => boolean): Promise<BufferGeometry | null> {
  const { positions, index } = refined(later.getAttribute('position').array, later.getIndex()!.array);
  const differences = new Float32Array(positions.length / 3);
  let started = performance.now();
  for (let i = 0; i < differences.length; ++i) {
    differences[i] = earlier.above(positions[3 * i]!, positions[3 * i + 1]!, positions[3 * i + 2]!);
    if (i % 256 !== 0 || performance.now() - started < kSlice) continue;
    await new Promise((resolve) => setTimeout(resolve));
    if (!isWanted()) return null;
    started = performance.now();
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('difference', new BufferAttribute(differences, 1));
  geometry.setIndex(new BufferAttribute(index, 1));
  return geometry;
}

const kUnknown = 0x5c5c5c;

/** Colors vertices by their difference, from `-range` to `range` [m]. */
export function colorByDifference(geometry: BufferGeometry, range: number): void {
  const differences = geometry.getAttribute('difference').array;
  const colors = new Uint8Array(differences.length * 3);
  const steps = Array.from({ length: 256 }, (_, i) => rampColor(i / 255, kDiverging));
  const unknown = rampColor(0, [kUnknown, kUnknown]);
  for (let i = 0; i < differences.length; ++i) {
    const difference = differences[i]!;
    const share = Math.min(1, Math.max(0, 0.5 + (0.5 * difference) / range));
    const color = Number.isNaN(difference) ? unknown : steps[Math.round(255 * share)]!;
    colors.set([255 * color.r, 255 * color.g, 255 * color.b], 3 * i);
  }
  geometry.setAttribute('color', new BufferAttribute(colors, 3, true));
}

/** [m] within which `share` of the known differences lie. */
export function rangeOf(differences: ArrayLike<number>, share: number): number {
  const known = Array.from(differences).filter((value) => !Number.isNaN(value)).map(Math.abs).sort((a, b) => a - b);
  return known[Math.min(known.length - 1, Math.floor(share * known.length))] ?? 0;
}
