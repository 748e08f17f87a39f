// All uploads of this page. They go on while somebody looks at other places of it.

import { DriveUpload, type Wishes } from './drive_upload.svelte';
import { drivesIn, type DroppedFile } from './drives_of_files';

const kAtOnce = 2;

class Uploads {
  all: DriveUpload[] = $state.raw([]);
  refused: { path: string; why: string }[] = $state.raw([]);

  constructor() {
    addEventListener('beforeunload', (event) => {
      if (this.all.some(({ state }) => state === 'sending' || state === 'assembling')) event.preventDefault(); // the browser asks
    });
  }

  get chosen(): DriveUpload[] {
    return this.all.filter(({ state }) => state === 'chosen');
  }
  get begun(): DriveUpload[] {
    return this.all.filter(({ state }) => state !== 'chosen');
  }

  /** Takes files; those that were begun before go on at once, the others wait until somebody says where to. */
  async add(files: DroppedFile[]): Promise<void> {
    const { drives, refused } = drivesIn(files);
    this.refused = refused;
    for (const found of drives) {
      const upload = new DriveUpload(found, () => this.startNext());
      const wasBegun = await upload.findBefore();
      if (wasBegun) upload.state = 'waiting';
      this.all = [...this.all, upload];
    }
    this.startNext();
  }

  /** Sends all that were chosen. */
  start(wishes: Wishes): void {
    for (const upload of this.chosen) {
      upload.wishes = wishes;
      upload.state = 'waiting';
    }
    this.startNext();
  }

  resume(upload: DriveUpload): void {
    upload.state = 'waiting';
    this.startNext();
  }

  async remove(upload: DriveUpload): Promise<void> {
    this.all = this.all.filter((other) => other !== upload);
    if (upload.state !== 'chosen') await upload.cancel();
  }

  private startNext(): void {
    const sending = this.all.filter(({ state }) => state === 'sending' || state === 'assembling').length;
    for (const upload of this.all.filter(({ state }) => state === 'waiting').slice(0, Math.max(0, kAtOnce - sending))) void upload.send();
  }
}

export const uploads = new Uploads();
