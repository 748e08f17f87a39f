import { expect, test } from 'vitest';

import { checksumsOf, groupFiles, savedAs, sizeOf, type MapFile } from './share_files';

const file = (name: string, bytes = 10): MapFile => ({ name, bytes, sha256: `hash-of-${name}`, content_type: 'text/plain', url: `/${name}` });
const kFiles = [
  'map.glb', 'slots.geojson', 'tileset.json', 'tiles/at_0_0.glb', 'surface.bin', 'news.txt',
  'day1/trajectory.tum', 'day1/loops.bin', 'day1/loops/3_9.jpg', 'day2/calibration.yaml',
].map((name) => file(name));

test('each file of a version is in one group', () => {
  const { groups, internal } = groupFiles(kFiles, ['day1', 'day2']);
  const names = groups.flatMap(({ downloads }) => downloads.map((one) => one.file.name));
  expect([...names, ...internal.map(({ name }) => name)].sort()).toEqual(kFiles.map(({ name }) => name).sort());
  expect(groups.map(({ title }) => title)).toEqual(['Ground', 'Parking', 'Drive day1', 'Drive day2', 'More']);
  expect(internal.map(({ name }) => name)).toEqual(['tiles/at_0_0.glb', 'surface.bin', 'day1/loops.bin', 'day1/loops/3_9.jpg']);
});

test('files are saved under names that say which map they are of', () => {
  expect(savedAs('lot', 2, 'day1/trajectory.tum')).toBe('lot-2-day1-trajectory.tum');
  expect(checksumsOf('lot', 2, [file('map.glb')])).toBe('hash-of-map.glb  lot-2-map.glb\n');
  expect(sizeOf([file('a', 3), file('b', 4)])).toBe(7);
});
