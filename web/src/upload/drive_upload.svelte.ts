// One drive on its way to the service, in one file or as a set of several.

import type { Upload } from 'tus-js-client';

import { addressOf, request, type Schemas } from '../api/client';
import { ask } from './ask';
import { fingerprintOf, forgetSet, rememberedSet, rememberSet } from './begun_sets';
import type { DroppedFile, FoundDrive } from './drives_of_files';
import { TransferRate } from './transfer_rate';
import { begunBefore, tusUpload } from './tus_upload';

/** "chosen" waits for somebody to start it, "waiting" for its turn; "assembling": the service makes one log of the parts. */
export type UploadState = 'chosen' | 'waiting' | 'sending' | 'paused' | 'assembling' | 'done' | 'failed';

export interface Wishes {
  site: string; // empty: a new one, named after the drive
  rig: string; // empty: the site's, or the calibration in the log
}

const kPartsAtOnce = 2;
const kAssemblyPoll = 1000; // [ms]
let nextNumber = 1;

export class DriveUpload {
  readonly number = nextNumber++;
  readonly bytes: number;
  state: UploadState = $state('chosen');
  bytesSent = $state(0);
  /** [bytes] that the service had already when this went on; 0: it began anew. */
  wentOnAt = $state(0);
  bytesPerSecond: number | null = $state(null);
  secondsLeft: number | null = $state(null);
  error = $state('');
  /** Whether the service said no: going on would end the same way. */
  isRefused = $state(false);
  drive: string | null = $state(null);
  job: string | null = $state(null);
  wishes: Wishes = $state.raw({ site: '', rig: '' });

  private readonly rate = new TransferRate();
  private readonly fingerprint: string;
  private uploads: Upload[] = [];
  private sentByPart = new Map<string, number>();
  private set: Schemas['UploadSet'] | null = null;

  constructor(
    readonly found: FoundDrive,
    /** Called when this one no longer sends, so that the next one may. */
    private readonly onIdle: () => void,
  ) {
    this.bytes = found.files.reduce((sum, { size }) => sum + size, 0);
    this.fingerprint = fingerprintOf(found);
  }

  /** Whether this browser began with these files before; the site and rig are those of then. */
  async findBefore(): Promise<boolean> {
    if (this.found.isSet) return (await this.setBefore()) !== null;
    const before = await begunBefore(this.found.files[0]!.source);
    if (!before) return false;
    this.wishes = { site: before.metadata['site'] ?? '', rig: before.metadata['rig'] ?? '' };
    return true;
  }

  async send(): Promise<void> {
    this.state = 'sending';
    this.error = '';
    this.isRefused = false;
    this.rate.reset();
    try {
      if (this.found.isSet) await this.sendSet();
      else await this.sendFile(this.found.files[0]!);
    } catch (error) {
      this.fail(error instanceof Error ? error.message : String(error), true);
    }
  }

  async pause(): Promise<void> {
    if (this.state !== 'sending' && this.state !== 'waiting') return;
    this.state = 'paused';
    this.forgetRate();
    await Promise.all(this.uploads.map((upload) => upload.abort()));
    this.onIdle();
  }

  /** Ends it, and has the service forget what came of it. */
  async cancel(): Promise<void> {
    const set = this.set;
    const isBegun = this.state !== 'done';
    this.state = 'paused';
    if (set) {
      await Promise.all(this.uploads.map((upload) => upload.abort()));
      forgetSet(this.fingerprint);
      if (isBegun) await request('delete', '/api/v1/upload-sets/{set}', { path: { set: set.id } }).catch(() => undefined); // it may have ended
    } else await Promise.all(this.uploads.map((upload) => upload.abort(isBegun).catch(() => undefined)));
    this.onIdle();
  }

  private async sendFile(file: DroppedFile): Promise<void> {
    const { site, rig } = this.wishes;
    const metadata = { filename: this.found.name, ...(site === '' ? {} : { site }), ...(rig === '' ? {} : { rig }) };
    const upload = tusUpload(file.source, { metadata }, {
      onBytes: (sent) => this.count(file.path, sent),
      onDone: (response) => this.finish(response.getHeader('Upload-Drive') ?? null, response.getHeader('Upload-Job') ?? null),
      onError: (message, isRefused) => this.fail(message, isRefused),
    });
    const before = await begunBefore(file.source);
    if (before) upload.resumeFromPreviousUpload(before);
    if (this.state !== 'sending') return; // paused meanwhile
    this.uploads = [upload];
    upload.start();
  }

  private async setBefore(): Promise<Schemas['UploadSet'] | null> {
    const id = rememberedSet(this.fingerprint);
    if (id === null) return null;
    const answer = await ask<Schemas['UploadSet']>(addressOf('get', '/api/v1/upload-sets/{set}', { path: { set: id } }));
    if (answer.is === 'silent') throw new Error('the service cannot be reached: go on when it is back');
    if (answer.is === 'gone' || answer.value.state !== 'receiving') {
      forgetSet(this.fingerprint); // it expired, or ended
      return null;
    }
    const set = answer.value;
    this.wishes = { site: set.site ?? '', rig: set.rig ?? '' };
    return set;
  }

  private async sendSet(): Promise<void> {
    const { site, rig } = this.wishes;
    const set =
      (await this.setBefore()) ??
      (await request('post', '/api/v1/upload-sets', {
        body: {
          filename: this.found.name,
          ...(site === '' ? {} : { site }),
          ...(rig === '' ? {} : { rig }),
          parts: this.found.files.map(({ path, size }) => ({ path, bytes: size })),
        },
      }));
    this.set = set;
    rememberSet(this.fingerprint, set.id);
    this.sentByPart = new Map(set.parts.map(({ path, offset }) => [path, offset]));
    this.wentOnAt = this.sum();
    this.bytesSent = this.wentOnAt;
    const ahead = set.parts.filter(({ offset, bytes }) => offset < bytes);
    await Promise.all(Array.from({ length: kPartsAtOnce }, () => this.sendParts(ahead)));
    if (this.state === 'sending') await this.awaitAssembly(set.id);
  }

  /** Sends parts one after the other until none is left, or this ends. */
  private async sendParts(ahead: Schemas['UploadSet']['parts']): Promise<void> {
    for (let part = ahead.shift(); part && this.state === 'sending'; part = ahead.shift()) {
      const { path, upload: url } = part;
      const file = this.found.files.find((candidate) => candidate.path === path);
      if (!file) throw new Error(`the service expects ${path}, which is not among the files`);
      await new Promise<void>((resolve) => {
        const upload = tusUpload(file.source, { url }, {
          onBytes: (sent) => this.count(path, sent),
          onDone: () => resolve(),
          onError: (message, isRefused) => {
            this.fail(`${path}: ${message}`, isRefused);
            resolve();
          },
        });
        this.uploads.push(upload);
        upload.start();
      });
    }
  }

  private async awaitAssembly(id: string): Promise<void> {
    this.state = 'assembling';
    this.forgetRate();
    for (;;) {
      const set = await request('get', '/api/v1/upload-sets/{set}', { path: { set: id } });
      if (set.state === 'done' || set.state === 'refused') forgetSet(this.fingerprint);
      if (set.state === 'done') return this.finish(set.drive, set.job);
      if (set.state === 'refused') return this.fail(set.error ?? 'the service refused the drive', true);
      await new Promise((resolve) => setTimeout(resolve, kAssemblyPoll));
    }
  }

  private sum(): number {
    return [...this.sentByPart.values()].reduce((sum, sent) => sum + sent, 0);
  }

  private count(path: string, sent: number): void {
    if (this.state !== 'sending') return;
    // What a file's first report says was there before it began.
    if (!this.found.isSet && !this.sentByPart.has(path)) this.wentOnAt = sent;
    this.sentByPart.set(path, sent);
    this.bytesSent = this.sum();
    this.rate.add(performance.now(), this.bytesSent);
    this.bytesPerSecond = this.rate.bytesPerSecond;
    this.secondsLeft = this.rate.secondsFor(this.bytes - this.bytesSent);
  }

  private forgetRate(): void {
    this.bytesPerSecond = null;
    this.secondsLeft = null;
  }

  private finish(drive: string | null, job: string | null): void {
    this.drive = drive;
    this.job = job;
    this.bytesSent = this.bytes;
    this.state = 'done';
    this.forgetRate();
    this.onIdle();
  }

  private fail(message: string, isRefused: boolean): void {
    if (this.state === 'failed' || this.state === 'paused') return; // the first reason is the one to show
    this.error = message;
    this.isRefused = isRefused;
    this.state = 'failed';
    this.forgetRate();
    for (const upload of this.uploads) void upload.abort();
    this.onIdle();
  }
}
