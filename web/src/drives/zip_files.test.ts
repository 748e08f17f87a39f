import { expect, test } from 'vitest';

import { readZip } from './zip_files';

// Of Python's zipfile: "a.yaml" stored with "x: 1\n", "b.txt" deflated with 200 times "parkade ", and an archive comment.
const kZip =
  'UEsDBBQAAAAAAAAAIVya7NOOBQAAAAUAAAAGAAAAYS55YW1seDogMQpQSwMEFAAAAAgAAAAhXLdVd20XAAAAQAYAAAUAAABiLnR4dCtILMpOTElVKBilR+lRepQepUdpEmgAUEsBAhQD' +
  'FAAAAAAAAAAhXJrs044FAAAABQAAAAYAAAAAAAAAAAAAAIABAAAAAGEueWFtbFBLAQIUAxQAAAAIAAAAIVy3VXdtFwAAAEAGAAAFAAAAAAAAAAAAAACAASkAAABiLnR4dFBLBQYAAAAA' +
  'AgACAGcAAABjAAAACQBhIGNvbW1lbnQ=';

const bytesOf = (base64: string) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)).buffer;

test('stored and deflated files are read', async () => {
  const files = await readZip(bytesOf(kZip));
  expect([...files.keys()]).toEqual(['a.yaml', 'b.txt']);
  const text = (name: string) => new TextDecoder().decode(files.get(name));
  expect(text('a.yaml')).toBe('x: 1\n');
  expect(text('b.txt')).toBe('parkade '.repeat(200));
});

test('what is no zip is refused', async () => {
  await expect(readZip(new ArrayBuffer(0))).rejects.toThrow('not a zip');
  await expect(readZip(new TextEncoder().encode('x'.repeat(100)).buffer)).rejects.toThrow('not a zip');
});
