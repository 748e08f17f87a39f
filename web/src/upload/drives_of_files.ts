// Which drives lie in what somebody dropped: files, folders, or folders of drives.

/** The part of a File that matters here. `path` is relative to what was dropped. */
export interface DroppedFile<Source = File> {
  path: string;
  size: number; // [bytes]
  source: Source;
}

/** One drive: a log in one file, or the files of a recording that was split or of a folder. */
export interface FoundDrive<Source = File> {
  name: string; // as the service is told
  isSet: boolean;
  files: DroppedFile<Source>[]; // paths within the drive
}

export interface FoundDrives<Source = File> {
  drives: FoundDrive<Source>[];
  /** What is no part of a drive, with the reason. */
  refused: { path: string; why: string }[];
}

const kLog = /\.(bag|mcap|db3)(\.zstd)?$/i;
const kWal = /-wal$/i; // beside a .db3: the rows that its recorder wrote last
const kArchive = /\.(zip|tar|tar\.gz|tgz|tar\.zst)$/i;
const kRig = /(camchain[^/]*|imu(\d*|-[^/]*)|vehicle)\.ya?ml$/i;
const kSplit = /^(.*?)[_.-](\d+)(\.(?:bag|mcap|db3)(?:\.zstd)?)$/i;

const folderOf = (path: string) => path.slice(0, Math.max(0, path.lastIndexOf('/')));
const nameOf = (path: string) => path.slice(path.lastIndexOf('/') + 1);
/** Files of the system, and KITTI's point clouds, which nobody reads. */
const isHidden = (path: string) => path.split('/').some((part) => part.startsWith('.') || ['__MACOSX', 'velodyne_points'].includes(part));

export function drivesIn<Source>(dropped: readonly DroppedFile<Source>[]): FoundDrives<Source> {
  const found: FoundDrives<Source> = { drives: [], refused: [] };
  let rest = dropped.filter(({ path }) => !isHidden(path));
  for (const root of folderRoots(rest)) {
    const isInside = ({ path }: DroppedFile<Source>) => root === '' || path.startsWith(`${root}/`);
    found.drives.push(setOf(nameOf(root) || 'drive', root, rest.filter(isInside), found));
    rest = rest.filter((file) => !isInside(file));
  }
  for (const [folder, files] of byFolder(rest)) addFolder(folder, files, found);
  return { ...found, drives: found.drives.filter(({ files }) => files.some(({ size }) => size > 0)) };
}

/** Folders that are one drive: EuRoC's, KITTI raw's with the calibration above it, and those of images and tables. */
function folderRoots<Source>(files: readonly DroppedFile<Source>[]): string[] {
  const above = (path: string) => folderOf(folderOf(path));
  const folders = (pattern: RegExp) => new Set(files.map(({ path }) => path).filter((path) => pattern.test(path)).map(above));
  const has = (path: string) => files.some((file) => file.path === path);
  const inside = (root: string, name: string) => (root === '' ? name : `${root}/${name}`);
  const euroc = [...folders(/(^|\/)cam\d+\/data\.csv$/)].map((root) => (nameOf(root) === 'mav0' ? folderOf(root) : root));
  const kitti = [...folders(/(^|\/)(oxts|image_\d+)\/timestamps\.txt$/)];
  const withCalibration = kitti.map((root) =>
    kitti.length === 1 && root !== '' && has(inside(folderOf(root), 'calib_cam_to_cam.txt')) ? folderOf(root) : root,
  );
  const plain = [...folders(/(^|\/)cam\d+\/[\d.]+\.(png|jpe?g)$/i)].filter((root) => has(inside(root, 'imu.csv')));
  return [...new Set([...euroc, ...withCalibration, ...plain])];
}

function byFolder<Source>(files: readonly DroppedFile<Source>[]): Map<string, DroppedFile<Source>[]> {
  const folders = new Map<string, DroppedFile<Source>[]>();
  for (const file of files) {
    const folder = folderOf(file.path);
    folders.set(folder, [...(folders.get(folder) ?? []), file]);
  }
  return folders;
}

function addFolder<Source>(folder: string, files: DroppedFile<Source>[], found: FoundDrives<Source>): void {
  const logs = files.filter(({ path }) => kLog.test(path));
  const hasMetadata = files.some(({ path }) => nameOf(path) === 'metadata.yaml');
  const isUsed = new Set<DroppedFile<Source>>();
  if (folder !== '' && logs.length > 0 && (hasMetadata || splitsOf(logs).length === 1)) {
    // A recording's own folder: its parts, and metadata.yaml beside them.
    const parts = files.filter(({ path }) => kLog.test(path) || kLog.test(path.replace(kWal, '')) || nameOf(path) === 'metadata.yaml');
    found.drives.push(setOf(nameOf(folder), folder, parts, found));
    parts.forEach((file) => isUsed.add(file));
  } else {
    const withWals = (group: DroppedFile<Source>[]) => [
      ...group,
      ...files.filter((file) => kWal.test(file.path) && group.some(({ path }) => path === file.path.replace(kWal, ''))),
    ];
    for (const group of splitsOf(logs).map(withWals)) {
      if (group.length === 1) found.drives.push(single(group[0]!, found));
      else found.drives.push(setOf(kSplit.exec(nameOf(group[0]!.path))?.[1] ?? nameOf(group[0]!.path), folder, group, found));
      group.forEach((file) => isUsed.add(file));
    }
  }
  for (const file of files) {
    if (isUsed.has(file)) continue;
    if (kArchive.test(file.path)) found.drives.push(single(file, found));
    else found.refused.push({ path: file.path, why: whyNot(file.path) });
  }
}

/** Logs that belong together: x_0.bag, x_1.bag, ... are one recording; day_1.bag and day_2.bag are two, for rosbag counts from 0. */
function splitsOf<Source>(logs: readonly DroppedFile<Source>[]): DroppedFile<Source>[][] {
  const groups = new Map<string, DroppedFile<Source>[]>();
  for (const log of logs) {
    const split = kSplit.exec(nameOf(log.path));
    const key = split ? `${split[1]}*${split[3]}` : log.path;
    groups.set(key, [...(groups.get(key) ?? []), log]);
  }
  const numberIn = (file: DroppedFile<Source>) => Number(kSplit.exec(nameOf(file.path))?.[2]);
  return [...groups.values()].flatMap((group) => {
    const sorted = [...group].sort((a, b) => numberIn(a) - numberIn(b));
    return sorted.length > 1 && sorted.every((file, i) => numberIn(file) === i) ? [sorted] : group.map((file) => [file]);
  });
}

function single<Source>(file: DroppedFile<Source>, found: FoundDrives<Source>): FoundDrive<Source> {
  refuseEmpty([file], found);
  return { name: nameOf(file.path), isSet: false, files: [{ ...file, path: nameOf(file.path) }] };
}

function setOf<Source>(name: string, folder: string, files: DroppedFile<Source>[], found: FoundDrives<Source>): FoundDrive<Source> {
  const kept = refuseEmpty(files, found);
  const within = kept.map((file) => ({ ...file, path: folder === '' ? file.path : file.path.slice(folder.length + 1) }));
  return { name, isSet: true, files: within };
}

function refuseEmpty<Source>(files: DroppedFile<Source>[], found: FoundDrives<Source>): DroppedFile<Source>[] {
  for (const { path, size } of files) if (size === 0) found.refused.push({ path, why: 'it is empty' });
  return files.filter(({ size }) => size > 0);
}

function whyNot(path: string): string {
  if (kRig.test(path)) return 'it belongs to a rig: add rigs under Rigs';
  return 'it is no drive log: those are ROS bags, MCAP, rosbag2, folders of EuRoC, KITTI raw or images and tables, and archives of them';
}

/** What the service takes as a site's or rig's name. */
export const isName = (text: string) => /^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$/.test(text);
