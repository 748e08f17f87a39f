import { expect, test } from 'vitest';

import { earlierFromLater, laterFromEarlier, moved, movedView } from './alignment';

const alignment = { translation: [10, 20, 0.5] as [number, number, number], yaw_deg: 90 };

test('the earlier site is turned, then moved', () => {
  moved([1, 0, 0], laterFromEarlier(alignment)).forEach((value, axis) => expect(value).toBeCloseTo([10, 21, 0.5][axis]!, 9));
});

test('a camera goes to the other site and comes back', () => {
  const view = { position: [3, -4, 12], target: [5, 6, -1] } as const;
  const there = movedView({ position: [...view.position], target: [...view.target] }, earlierFromLater(alignment));
  const back = movedView(there, laterFromEarlier(alignment));
  back.position.forEach((value, axis) => expect(value).toBeCloseTo(view.position[axis]!, 9));
  back.target.forEach((value, axis) => expect(value).toBeCloseTo(view.target[axis]!, 9));
  expect(there.position[0]).not.toBeCloseTo(view.position[0], 1);
});
