import { expect, test } from 'vitest';

import { drivesIn, isName } from './drives_of_files';

const files = (...paths: string[]) => paths.map((path) => ({ path, size: 10, source: path }));
const short = (paths: string[]) =>
  drivesIn(files(...paths)).drives.map(({ name, isSet, files: parts }) => [name, isSet, parts.map(({ path }) => path)]);

test('files are drives of their own', () => {
  expect(short(['monday.mcap', 'tuesday.bag', 'archive.tar.gz'])).toEqual([
    ['monday.mcap', false, ['monday.mcap']],
    ['tuesday.bag', false, ['tuesday.bag']],
    ['archive.tar.gz', false, ['archive.tar.gz']],
  ]);
});

test('a recording that was split is one drive, in order', () => {
  expect(short(['tour_1.bag', 'tour_10.bag', 'tour_0.bag', ...[2, 3, 4, 5, 6, 7, 8, 9].map((i) => `tour_${i}.bag`)])[0]).toEqual([
    'tour', true, Array.from({ length: 11 }, (_, i) => `tour_${i}.bag`),
  ]);
  // Numbers that do not count from 0 are names.
  expect(short(['day_1.bag', 'day_2.bag'])).toHaveLength(2);
  expect(short(['tour_0.bag', 'tour_1.mcap'])).toHaveLength(2);
});

test('the folder of a rosbag2 recording is one drive with its metadata', () => {
  expect(short(['rec/rec_0.db3', 'rec/rec_1.db3', 'rec/metadata.yaml', 'rec/.DS_Store'])).toEqual([
    ['rec', true, ['rec_0.db3', 'rec_1.db3', 'metadata.yaml']],
  ]);
});

test('the last rows of a recorder that was killed come with its database', () => {
  expect(short(['rec/rec_0.db3', 'rec/rec_0.db3-shm', 'rec/rec_0.db3-wal'])).toEqual([['rec', true, ['rec_0.db3', 'rec_0.db3-wal']]]);
  expect(short(['other.bag', 'mon.db3', 'mon.db3-wal', 'tue.db3'])).toEqual([
    ['other.bag', false, ['other.bag']],
    ['mon.db3', true, ['mon.db3', 'mon.db3-wal']],
    ['tue.db3', false, ['tue.db3']],
  ]);
});

test('a folder of drives is several', () => {
  expect(short(['week/mon.mcap', 'week/tue.mcap', 'week/wed/wed_0.bag', 'week/wed/wed_1.bag'])).toEqual([
    ['mon.mcap', false, ['mon.mcap']],
    ['tue.mcap', false, ['tue.mcap']],
    ['wed', true, ['wed_0.bag', 'wed_1.bag']],
  ]);
});

test('an EuRoC folder is one drive with all that is in it', () => {
  const inside = ['mav0/cam0/data.csv', 'mav0/cam0/data/1.png', 'mav0/imu0/data.csv', 'mav0/cam0/sensor.yaml'];
  expect(short(inside.map((path) => `V1_01/${path}`))).toEqual([['V1_01', true, inside]]);
  expect(short(['garage/cam0/data.csv', 'garage/imu0/data.csv', 'other.bag'])).toEqual([
    ['garage', true, ['cam0/data.csv', 'imu0/data.csv']],
    ['other.bag', false, ['other.bag']],
  ]);
});

test('a KITTI raw folder is one drive with the calibration above it', () => {
  const inside = ['run_sync/oxts/timestamps.txt', 'run_sync/image_02/timestamps.txt', 'run_sync/image_02/data/0000000000.png', 'calib_cam_to_cam.txt'];
  expect(short(inside.map((path) => `2011_09_26/${path}`))).toEqual([['2011_09_26', true, inside]]);
});

test('images called by their stamps and tables are one drive', () => {
  const inside = ['cam0/1317042651.168.png', 'imu.csv', 'gnss.csv'];
  expect(short(inside.map((path) => `lot/${path}`))).toEqual([['lot', true, inside]]);
});

test('what is no drive is said, with the reason', () => {
  const { drives, refused } = drivesIn([...files('notes.txt', 'rig/camchain-imucam.yaml'), { path: 'empty.bag', size: 0, source: '' }]);
  expect(drives).toEqual([]);
  expect(refused.map(({ path, why }) => [path, why.split(':')[0]])).toEqual([
    ['empty.bag', 'it is empty'],
    ['notes.txt', 'it is no drive log'],
    ['rig/camchain-imucam.yaml', 'it belongs to a rig'],
  ]);
});

test('names of sites', () => {
  for (const good of ['lot', 'level-2', 'P.3_a']) expect(isName(good)).toBe(true);
  for (const bad of ['', 'my site', 'ü', '..', 'a/b']) expect(isName(bad)).toBe(false);
});
