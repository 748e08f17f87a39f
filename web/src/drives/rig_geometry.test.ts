import { expect, test } from 'vitest';

import { applied, inverse, lookOf, rigOf, times, type Rigid } from './rig_geometry';

const bytes = (source: string) => new TextEncoder().encode(source);
// The front camera and vehicle of a rig of the simulator.
const kChain = `cam0:
  camera_model: pinhole
  intrinsics: [199.32, 199.35, 316.99, 200.54]
  distortion_model: equidistant
  resolution: [640, 400]
  rostopic: /cam0/image_raw
  mask: cam0_mask.png
  T_cam_imu:
    - [-0.0027959856878971845, -0.99997045529451567, -0.0071603772325267157, -0.10103993459612948]
    - [-0.34596838127498281, 0.0076855208426788169, -0.93821469394128809, 1.1372824445406189]
    - [0.93824200589293649, -0.00014597073597916177, -0.34597964834733119, -2.4024768447500997]
    - [0, 0, 0, 1]
`;
const kVehicle = `T_imu_body:
  - [0.99966029899465114, -0.0016682034081691754, -0.02600968495221721, -0.60436411537538903]
  - [0.0018266009047964605, 0.99997992504912547, 0.0060673740514327118, -0.11838613972415828]
  - [0.025999041194998292, -0.0061128222724348034, 0.99964327800511243, -0.49354121480077151]
  - [0, 0, 0, 1]
wheelbase: 2.5
track: 1.48
p_body_gnss: [0.35, 0.02, 1.51]
`;

test('cameras lie where their files say, in the frame of the body', () => {
  const rig = rigOf(new Map([['camchain-imucam.yaml', bytes(kChain)], ['vehicle.yaml', bytes(kVehicle)]]));
  const [camera] = rig.cameras;
  expect(rig).toMatchObject({ hasBody: true, wheelbase: 2.5, track: 1.48, gnss: [0.35, 0.02, 1.51] });
  expect(camera).toMatchObject({ name: 'cam0', width: 640, height: 400, lens: 'fisheye', mask: 'cam0_mask.png' });
  // At the nose of the car, before the rear axle, at the height of its hood; it looks ahead and down.
  expect(camera!.pose.translation[0]).toBeCloseTo(3.3, 0);
  expect(camera!.pose.translation[1]).toBeCloseTo(0, 1);
  expect(camera!.pose.translation[2]).toBeGreaterThan(0.4);
  expect(lookOf(camera!.pose)).toMatch(/^front, (19|20|21|22)° down$/);
  expect(camera!.halfWidth).toBeCloseTo(323.01 / 199.32, 2); // [radians]: beyond a right angle, as fisheyes see
});

test('without a vehicle the IMU is the origin', () => {
  const rig = rigOf(new Map([['rig/camchain-imucam.yaml', bytes(kChain)]]));
  expect(rig).toMatchObject({ hasBody: false, imu: [0, 0, 0], gnss: null, wheelbase: null });
});

test('what is missing is named', () => {
  expect(() => rigOf(new Map())).toThrow('no camchain-imucam.yaml');
  const only = (source: string) => () => rigOf(new Map([['camchain-imucam.yaml', bytes(source)]]));
  expect(only('other: 1\n')).toThrow('names no camera');
  expect(only('cam0:\n  resolution: [640, 400]\n')).toThrow('cam0 has no T_cam_imu');
  expect(only(kChain.replace('[640, 400]', '[640]'))).toThrow('resolution must be 2 numbers');
});

test('transforms are undone by their inverse', () => {
  const turn: Rigid = { rotation: [[0, -1, 0], [1, 0, 0], [0, 0, 1]], translation: [1, 2, 3] };
  expect(applied(turn, [1, 0, 0])).toEqual([1, 3, 3]);
  const back = applied(times(inverse(turn), turn), [4, 5, 6]);
  [4, 5, 6].forEach((value, i) => expect(back[i]).toBeCloseTo(value, 12));
});

test('directions are those of a driver', () => {
  const looking = (x: number, y: number, z: number): Rigid => ({ rotation: [[0, 0, x], [0, 0, y], [0, 0, z]], translation: [0, 0, 0] });
  expect(lookOf(looking(0, 1, 0))).toBe('left, level');
  expect(lookOf(looking(0, -0.8, -0.6))).toBe('right, 37° down');
  expect(lookOf(looking(-1, 0.01, 0))).toBe('back, level');
  expect(lookOf(looking(0, 0, -1))).toBe('straight down');
});
