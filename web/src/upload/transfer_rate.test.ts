import { expect, test } from 'vitest';

import { TransferRate } from './transfer_rate';

test('the rate is that of the last seconds', () => {
  const rate = new TransferRate();
  for (let second = 0; second <= 60; ++second) rate.add(second * 1000, second < 30 ? second * 100 : 3000 + (second - 30) * 1000);
  expect(rate.bytesPerSecond).toBeCloseTo(1000);
  expect(rate.secondsFor(5000)).toBeCloseTo(5);
});

test('nothing is said of a line that has only begun, stands still, or was cut', () => {
  const rate = new TransferRate();
  expect(rate.secondsFor(1)).toBeNull();
  rate.add(0, 0);
  rate.add(100, 1e6);
  expect(rate.bytesPerSecond).toBeNull();
  for (let second = 1; second < 20; ++second) rate.add(second * 1000, 1e6);
  expect(rate.bytesPerSecond).toBe(0);
  expect(rate.secondsFor(1)).toBeNull();
  rate.add(20_000, 5e5);
  expect(rate.bytesPerSecond).toBeNull();
});
