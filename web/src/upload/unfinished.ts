// Uploads that this browser began, and that wait at the service for the rest of their files.

import { defaultOptions, Upload } from 'tus-js-client';

import { addressOf, changeHeaders, request, type Schemas } from '../api/client';
import { ask } from './ask';
import { forgetSet, rememberedSets } from './begun_sets';

export interface Unfinished {
  name: string;
  site: string | null;
  bytes: number;
  offset: number; // [bytes] that the service has
  forget: () => Promise<void>;
}

const fileUploads = () => defaultOptions.urlStorage.findAllUploads();

async function unfinishedFile({ uploadUrl, urlStorageKey }: Awaited<ReturnType<typeof fileUploads>>[number]): Promise<Unfinished | null> {
  const drop = () => defaultOptions.urlStorage.removeUpload(urlStorageKey);
  const id = uploadUrl?.split('/').at(-1) ?? '';
  const answer = await ask<Schemas['Upload']>(addressOf('get', '/api/v1/uploads/{upload}', { path: { upload: id } }));
  if (answer.is === 'silent') return null;
  if (answer.is === 'gone' || answer.value.state !== 'receiving') return drop().then(() => null);
  const forget = async () => {
    await Upload.terminate(uploadUrl ?? '', { headers: changeHeaders() });
    await drop();
  };
  const { filename: name, site, length: bytes, offset } = answer.value;
  return { name, site, bytes, offset, forget };
}

async function unfinishedSet([fingerprint, id]: [string, string]): Promise<Unfinished | null> {
  const answer = await ask<Schemas['UploadSet']>(addressOf('get', '/api/v1/upload-sets/{set}', { path: { set: id } }));
  if (answer.is === 'silent') return null;
  if (answer.is === 'gone' || answer.value.state !== 'receiving') {
    forgetSet(fingerprint);
    return null;
  }
  const forget = async () => {
    await request('delete', '/api/v1/upload-sets/{set}', { path: { set: id } });
    forgetSet(fingerprint);
  };
  const { filename: name, site, parts } = answer.value;
  const sum = (of: 'bytes' | 'offset') => parts.reduce((total, part) => total + part[of], 0);
  return { name, site, bytes: sum('bytes'), offset: sum('offset'), forget };
}

export async function listUnfinished(): Promise<Unfinished[]> {
  const found = await Promise.all([...(await fileUploads()).map(unfinishedFile), ...rememberedSets().map(unfinishedSet)]);
  return found.filter((one) => one !== null);
}
