// Upload sets that were begun in this browser, so that choosing the same files again goes on with them.

import type { FoundDrive } from './drives_of_files';

const kPrefix = 'parkade.upload-set.';

/** Tells one choice of files from another: names, sizes and times, not contents. */
export function fingerprintOf(drive: FoundDrive): string {
  const text = [drive.name, ...drive.files.map(({ path, size, source }) => `${path}:${size}:${source.lastModified}`).sort()].join('\n');
  // FNV-1a, 64 bits.
  let hash = 0xcbf29ce484222325n;
  for (const byte of new TextEncoder().encode(text)) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
  return hash.toString(16).padStart(16, '0');
}

export const rememberSet = (fingerprint: string, set: string) => localStorage.setItem(kPrefix + fingerprint, set);
export const rememberedSet = (fingerprint: string) => localStorage.getItem(kPrefix + fingerprint);
export const forgetSet = (fingerprint: string) => localStorage.removeItem(kPrefix + fingerprint);

/** All of them: fingerprint and id. */
export function rememberedSets(): [string, string][] {
  return Object.keys(localStorage)
    .filter((key) => key.startsWith(kPrefix))
    .map((key) => [key.slice(kPrefix.length), localStorage.getItem(key) ?? '']);
}
