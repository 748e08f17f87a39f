// The files of a small zip, as the service sends rigs: stored or deflated, without encryption and without zip64.

const kEnd = 0x06054b50;
const kEntry = 0x02014b50;
const kEndBytes = 22;
const kEntryBytes = 46;
const kLocalBytes = 30;

/** By name; folders are passed over. Throws where this is no zip. */
export async function readZip(archive: ArrayBuffer): Promise<Map<string, Uint8Array<ArrayBuffer>>> {
  const view = new DataView(archive);
  const files = new Map<string, Uint8Array<ArrayBuffer>>();
  let at = view.byteLength - kEndBytes;
  while (at >= 0 && view.getUint32(at, true) !== kEnd) at -= 1; // a comment may follow it
  if (at < 0) throw new Error('this is not a zip archive');
  const count = view.getUint16(at + 10, true);
  let entry = view.getUint32(at + 16, true);
  for (let i = 0; i < count; ++i) {
    if (entry + kEntryBytes > view.byteLength || view.getUint32(entry, true) !== kEntry) throw new Error('the zip archive is damaged');
    const method = view.getUint16(entry + 10, true);
    const packedBytes = view.getUint32(entry + 20, true);
    const nameBytes = view.getUint16(entry + 28, true);
    const name = new TextDecoder().decode(new Uint8Array(archive, entry + kEntryBytes, nameBytes));
    const local = view.getUint32(entry + 42, true);
    const data = local + kLocalBytes + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
    if (!name.endsWith('/')) files.set(name, await unpack(new Uint8Array(archive, data, packedBytes), method, name));
    entry += kEntryBytes + nameBytes + view.getUint16(entry + 30, true) + view.getUint16(entry + 32, true);
  }
  return files;
}

async function unpack(packed: Uint8Array<ArrayBuffer>, method: number, name: string): Promise<Uint8Array<ArrayBuffer>> {
  if (method === 0) return packed;
  if (method !== 8) throw new Error(`${name} is packed in a way that this page cannot read`);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
