import { expect, test } from 'vitest';

import { findingsOf, sentence, type Inspection } from './inspection_words';

const topic: Inspection['topics'][number] = {
  topic: '/cam0', type: 'sensor_msgs/CompressedImage', messages: 1200, bytes: 1, rate_hz: 10, duration_s: 120, gaps: [], repeated: 0, backward: 0,
  largest_backward_jump_s: 0, without_stamp: 0, damaged: 0, implausible: 0, other_sizes: 0, first_fault: '',
};
const clean: Inspection = {
  name: 'a.mcap', format: 'MCAP', bytes: 1, begin: '100.5', end: '220.5', duration_s: 120, topics: [topic],
  damage: { ranges: [], lost_messages: 0, is_truncated: false }, rig: null, missing: [], warnings: [], state: 'clean', exit_status: 0,
};

test('of a clean log its content is said, and nothing else', () => {
  expect(findingsOf(clean)).toEqual([{ kind: 'good', text: '2 min 00 s with 1,200 messages of 1 stream.' }]);
});

test('what is missing comes first, then what costs quality', () => {
  const findings = findingsOf({
    ...clean,
    missing: ['no IMU'],
    damage: { ranges: [{ what: 'chunk', topic: '', messages: 3 }], lost_messages: 3, is_truncated: true },
    topics: [{
      ...topic,
      gaps: [{ begin: '110.5', seconds: 0.5 }, { begin: '165.5', seconds: 2.25 }],
      damaged: 1,
      picture_faults: [{ kind: 'dark', begin: '100.5', end: '104.5', share: 1 }],
    }],
  });
  expect(findings.map(({ kind }) => kind)).toEqual(['bad', 'warn', 'warn', 'warn', 'warn', 'warn', 'good']);
  expect(findings.slice(0, 6).map(({ text }) => text)).toEqual([
    'No IMU.',
    'The recording was cut off: its end is missing.',
    '3 messages cannot be read, in 1 damaged place of the file.',
    '/cam0 has 2 gaps; the longest is 2.3 s 1 min 05 s after the start.',
    '/cam0: 1 of 1,200 messages cannot be decoded.',
    '/cam0 shows next to nothing, it is too dark, for 4 s 0 s after the start.',
  ]);
});

test('sentences are not ended twice', () => expect(sentence('it is full.')).toBe('It is full.'));
