import { expect, test } from 'vitest';

import { parseYaml } from './rig_yaml';

test('a rig as Parkade writes it', () => {
  const rig = parseYaml(`%YAML:1.0
---
# front
cam0:
  camera_model: pinhole
  intrinsics: [199.3, 199.4, 316.9, 2e2]
  timeshift_cam_imu: 0   # [s]
  mask: "cam0 #1.png"
  T_cam_imu:
    - [-0.5, 1, 0, .25]
    - [0, 0, -1e-3, 1.]
cam1:
  resolution: [640, 400]
  rostopic: /cam1/image_raw
`);
  expect(rig).toEqual({
    cam0: {
      camera_model: 'pinhole',
      intrinsics: [199.3, 199.4, 316.9, 200],
      timeshift_cam_imu: 0,
      mask: 'cam0 #1.png',
      T_cam_imu: [[-0.5, 1, 0, 0.25], [0, 0, -0.001, 1]],
    },
    cam1: { resolution: [640, 400], rostopic: '/cam1/image_raw' },
  });
});

test('matrices in every way that Kalibr and PyYAML write them', () => {
  const matrix = [[1, 0], [0, 1]];
  expect(parseYaml('T:\n- [1, 0]\n- [0, 1]\n')).toEqual({ T: matrix });
  expect(parseYaml('T: [[1, 0], [0, 1]]')).toEqual({ T: matrix });
  expect(parseYaml('T: [[1, 0],\n    [0, 1]]\nx: 2')).toEqual({ T: matrix, x: 2 });
  expect(parseYaml('T:\n- - 1.0\n  - 0.0\n- - 0.0\n  - 1.0\n')).toEqual({ T: matrix });
  expect(parseYaml('T:\n  -\n    - 1\n    - 0\n  -\n    - 0\n    - 1\n')).toEqual({ T: matrix });
});

test('values of other kinds', () => {
  expect(parseYaml('a: "yes: no"\nb: true\nc: ~\nd:\ne: []\n')).toEqual({ a: 'yes: no', b: true, c: null, d: null, e: [] });
  expect(parseYaml('')).toEqual({});
});

test('what is not understood is named by its line', () => {
  expect(() => parseYaml('a: 1\nwhat is this\n')).toThrow('line 2');
  expect(() => parseYaml('a: [1, [2, 3]\n')).toThrow('line 1: a list has no end');
  expect(() => parseYaml('a: 1\n   b: 2\n')).toThrow('line 2');
  expect(() => parseYaml('- 1\n')).toThrow('a key was expected');
});
