// One file on its way to the service by tus: it goes on where it was after pauses, faults of the line and restarts of the browser.

import { DetailedError, Upload, type HttpResponse } from 'tus-js-client';

import { addressOf, changeHeaders, refusalIn } from '../api/client';

const kChunkBytes = 32 << 20; // an offset is durable after each, and no proxy's time limit ends a whole upload
const kRetryDelays = [0, 1000, 3000, 5000, 10_000, 20_000]; // [ms]
const kNoRoom = 507;

export interface TusEvents {
  onBytes: (sent: number) => void;
  onDone: (response: HttpResponse) => void;
  onError: (message: string, isRefused: boolean) => void;
}

type Target =
  | { metadata: Record<string, string> } // a new upload, or the one that was begun with this file before
  | { url: string }; // one that the service has begun already

export function tusUpload(file: File, target: Target, events: TusEvents): Upload {
  return new Upload(file, {
    endpoint: addressOf('post', '/api/v1/uploads'),
    ...('url' in target ? { uploadUrl: target.url, storeFingerprintForResuming: false } : { metadata: target.metadata }),
    chunkSize: kChunkBytes,
    retryDelays: kRetryDelays,
    removeFingerprintOnSuccess: true,
    onBeforeRequest: (request) => {
      for (const [name, value] of Object.entries(changeHeaders())) request.setHeader(name, value);
    },
    onShouldRetry: (error) => {
      const status = error.originalResponse?.getStatus() ?? 0;
      return status === 0 || status === 409 || status === 423 || (status >= 500 && status !== kNoRoom);
    },
    onProgress: (sent) => events.onBytes(sent),
    onSuccess: ({ lastResponse }) => events.onDone(lastResponse),
    onError: (error) => {
      const response = error instanceof DetailedError ? error.originalResponse : null;
      if (response) events.onError(refusalIn(response.getBody(), response.getStatus()), true);
      else events.onError('the service cannot be reached: go on when it is back', false);
    },
  });
}

/** What was begun with this file before and not finished, newest last. */
export async function begunBefore(file: File) {
  const silent = { onBytes: () => undefined, onDone: () => undefined, onError: () => undefined };
  const uploads = await tusUpload(file, { metadata: {} }, silent).findPreviousUploads();
  return uploads.sort((a, b) => Date.parse(a.creationTime) - Date.parse(b.creationTime)).at(-1) ?? null;
}
