import { expect, test } from 'vitest';

import { shownTime } from './shown_time';

test('paused it is the time itself', () => expect(shownTime(1.2345, false, 4)).toEqual({ now: 1.2345, ahead: null }));

test('playing, what was got ready is what is shown next', () => {
  const { now, ahead } = shownTime(1.29, true, 1);
  expect(now).toBeCloseTo(1.2);
  expect(shownTime(1.4, true, 1).now).toBe(ahead);
});

test('faster takes longer steps of the drive, slower no shorter ones', () => {
  const { now, ahead } = shownTime(3.3, true, 8);
  expect([now, ahead]).toEqual([expect.closeTo(3.2), expect.closeTo(4.8)]);
  expect(shownTime(0.3, true, 0.5).ahead).toBe(0.4);
});
