// The files in what was dropped or chosen, folders included.

import type { DroppedFile } from './drives_of_files';

/** To be called while the drop is handled: the browser forgets its items right after. */
export async function filesOfDrop(transfer: DataTransfer): Promise<DroppedFile[]> {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  const plain = [...transfer.files];
  if (entries.length === 0) return plain.map((file) => dropped(file, file.name));
  return (await Promise.all(entries.map((entry) => filesOfEntry(entry)))).flat();
}

/** Of an input; one for folders knows where in the folder each file lay. */
export function filesOfInput(input: HTMLInputElement): DroppedFile[] {
  return [...(input.files ?? [])].map((file) => dropped(file, file.webkitRelativePath || file.name));
}

function dropped(file: File, path: string): DroppedFile {
  return { path, size: file.size, source: file };
}

async function filesOfEntry(entry: FileSystemEntry): Promise<DroppedFile[]> {
  const path = entry.fullPath.replace(/^\//, '');
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [dropped(file, path)];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const files: DroppedFile[] = [];
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject)); // a hundred at a time
    if (some.length === 0) return files;
    for (const inner of some) files.push(...(await filesOfEntry(inner)));
  }
}
