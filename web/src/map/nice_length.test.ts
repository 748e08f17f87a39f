import { expect, test } from 'vitest';

import { niceLength } from './nice_length';

test('a scale bar has a length that people know', () => {
  expect([0.03, 0.9, 1, 3.7, 49, 50, 730].map(niceLength)).toEqual([0.02, 0.5, 1, 2, 20, 50, 500]);
});
