// Writes the sample drive with the official MCAP writer.
//   node write_mcap.mjs OUT.mcap [profile=ros1|ros2] [compression=none|lz4|zstd] [chunks=no] [index=no] [summary=no]
//                       [order=swapped]
// and OUT.mcap.json: the chunks as [begin, end, messages], in the order of the file.
import { McapIndexedReader, McapWriter } from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";
import lz4 from "lz4js";
import { open, readFile, writeFile } from "node:fs/promises";
import { TOPICS, messages } from "./sample.mjs";

const [out, ...settings] = process.argv.slice(2);
const options = { profile: "ros2", compression: "none", chunks: "yes", index: "yes", summary: "yes", order: "by-time" };
for (const setting of settings) Object.assign(options, Object.fromEntries([setting.split("=")]));
await zstd.isLoaded;

class FileWriter {
  #position = 0n;
  #file;
  constructor(file) {
    this.#file = file;
  }
  position() {
    return this.#position;
  }
  async write(bytes) {
    await this.#file.write(bytes);
    this.#position += BigInt(bytes.byteLength);
  }
}

const compress = { lz4: (bytes) => lz4.compress(bytes), zstd: (bytes) => zstd.compress(bytes, 3) }[options.compression];
let numMessages = 0;
const ends = []; // messages written when each chunk was closed
const has_summary = options.summary === "yes";
const file = await open(out, "w");
const writer = new McapWriter({
  writable: new FileWriter(file),
  useChunks: options.chunks === "yes",
  useMessageIndex: options.index === "yes",
  useChunkIndex: has_summary,
  useStatistics: has_summary,
  useSummaryOffsets: has_summary,
  repeatSchemas: has_summary,
  repeatChannels: has_summary,
  chunkSize: 65536,
  compressChunk: (bytes) => {
    ends.push(numMessages);
    return { compression: compress ? options.compression : "", compressedData: compress ? compress(bytes) : bytes };
  },
});
await writer.start({ profile: options.profile, library: "" });
const is_ros1 = options.profile === "ros1";
const channels = [];
for (const { topic, type } of TOPICS) {
  const schemaId = await writer.registerSchema({
    name: is_ros1 ? type : type.replace("/", "/msg/"),
    encoding: is_ros1 ? "ros1msg" : "ros2msg",
    data: new TextEncoder().encode("uint8[] data"),
  });
  const messageEncoding = is_ros1 ? "ros1" : "cdr";
  channels.push(await writer.registerChannel({ schemaId, topic, messageEncoding, metadata: new Map() }));
}
const list = [...messages()];
if (options.order === "swapped")
  for (let i = 0; i + 100 <= list.length; i += 100) list.splice(i, 100, ...list.slice(i + 50, i + 100), ...list.slice(i, i + 50));
for (const { topic, tick, time, data } of list) {
  // A chunk is closed after the message that filled it.
  ++numMessages;
  await writer.addMessage({ channelId: channels[topic], sequence: tick, logTime: time, publishTime: time, data });
}
await writer.end();
await file.close();

const bytes = await readFile(out);
const chunks = [];
if (options.chunks === "yes") {
  // Walk the records: opcode, 64-bit length.
  let previous = 0;
  for (let offset = 8; offset + 9 <= bytes.length - 8; ) {
    const length = Number(bytes.readBigUInt64LE(offset + 1));
    if (bytes[offset] === 6) {
      const end = ends[chunks.length];
      chunks.push([offset, offset + 9 + length, end - previous]);
      previous = end;
    }
    offset += 9 + length;
  }
}
await writeFile(out + ".json", JSON.stringify({ chunks }));
