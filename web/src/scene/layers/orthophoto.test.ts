import { expect, test } from 'vitest';

import { frameOf, netOver, sizeOfPng } from './orthophoto';

test('a world file names the center of the upper left pixel', () => {
  const frame = frameOf('0.020000000\n0\n0\n-0.020000000\n-10.790000000\n26.950000000\n', 2019, 1775);
  expect(frame.left).toBeCloseTo(-10.8);
  expect(frame.top).toBeCloseTo(26.96);
  expect(frame.width).toBeCloseTo(40.38);
  expect(frame.height).toBeCloseTo(35.5);
});

test('what is no world file with north up is refused', () => {
  expect(() => frameOf('0.02\n0.1\n0\n-0.02\n0\n0', 10, 10)).toThrow('world file');
  expect(() => frameOf('', 10, 10)).toThrow('world file');
});

test('a PNG file says its size', () => {
  const view = new DataView(new ArrayBuffer(24));
  view.setUint32(0, 0x89504e47);
  view.setUint32(16, 2019);
  view.setUint32(20, 1775);
  expect(sizeOfPng(view.buffer)).toEqual([2019, 1775]);
  expect(() => sizeOfPng(new ArrayBuffer(24))).toThrow('no PNG');
});

test('the net follows the ground, and continues it where there is none', () => {
  const net = netOver({ left: 0, top: 10, width: 20, height: 10 }, (x) => (x > 10 ? 3 : x === 10 ? 1 : null), -1);
  const position = net.getAttribute('position');
  net.computeBoundingBox();
  expect(net.boundingBox!.min.toArray().slice(0, 2)).toEqual([0, 0]);
  expect(net.boundingBox!.max.toArray().slice(0, 2)).toEqual([20, 10]);
  const heights = new Set(Array.from({ length: position.count }, (_, i) => Math.round(position.getZ(i))));
  expect([...heights].sort((a, b) => a - b)).toEqual([1, 3]);
  expect(position.count).toBe(21 * 11);
  expect(netOver({ left: 0, top: 1, width: 1, height: 1 }, () => null, -1).getAttribute('position').getZ(0)).toBeCloseTo(-1, 0);
});
