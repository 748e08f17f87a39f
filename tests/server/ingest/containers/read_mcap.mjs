// Reads the sample drive back with the official reader: prints the number of messages that are as they should be, and
// fails when one is not.
//   node read_mcap.mjs FILE.mcap indexed|streamed
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";
import decompressLz4 from "@foxglove/wasm-lz4";
import { readFile } from "node:fs/promises";
import { TOPICS, payload } from "./sample.mjs";

const [path, way] = process.argv.slice(2);
await zstd.isLoaded;
await decompressLz4.isLoaded;
const decompressHandlers = {
  lz4: (bytes, size) => decompressLz4(bytes, Number(size)),
  zstd: (bytes, size) => zstd.decompress(bytes, Number(size)),
};
const bytes = await readFile(path);

async function* indexed() {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  for await (const message of reader.readMessages()) yield { message, channel: reader.channelsById.get(message.channelId) };
}

async function* streamed() {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  const channels = new Map();
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") yield { message: record, channel: channels.get(record.channelId) };
  }
  if (!reader.done()) throw new Error("the file does not end as it should");
}

let count = 0;
for await (const { message, channel } of way === "indexed" ? indexed() : streamed()) {
  const topic = TOPICS.findIndex((candidate) => candidate.topic === channel.topic);
  const tick = Number((message.logTime - 1_700_000_000_000_000_000n) / 10_000_000n);
  if (Buffer.compare(message.data, payload(topic, tick)) !== 0) throw new Error(`message ${count} is wrong`);
  ++count;
}
console.log(count);
