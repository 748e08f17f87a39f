#include "server/ingest/writing/mcap_writer.h"

#include <zlib.h>

#include "core/files/file_error.h"
#include "server/ingest/writing/mcap_records.h"

namespace parkade {
namespace {

std::string SchemaEncoding(const std::string& message_encoding) {
  if (message_encoding == "ros1") return "ros1msg";
  if (message_encoding == "json") return "jsonschema";
  return message_encoding == "cdr" ? "ros2msg" : message_encoding;
}

using Opcode = McapRecord::Opcode;
using enum McapRecord::Opcode;

constexpr const auto& kMagic = McapRecord::kMagic;

std::uint32_t UpdateCrc(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

std::vector<std::uint8_t> Record(Opcode opcode, const ByteWriter& body) {
  ByteWriter record;
  record.Number(static_cast<std::uint8_t>(opcode)).Number(static_cast<std::uint64_t>(body.size()));
  record.Bytes(body.bytes());
  return record.bytes();
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& file, const std::string& profile,
                       const McapWriterOptions& options)
    : options_(options), path_(file), file_(file, std::ios::binary) {
  Emit(kMagic);
  ByteWriter header;
  header.PrefixedText(profile).PrefixedText("parkade");
  Emit(Record(kHeader, header));
}

int McapWriter::AddChannel(const std::string& topic, const std::string& type,
                           const std::string& schema_text, const std::string& encoding) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  ByteWriter schema;  // schema ids start at 1: 0 means "no schema"
  schema.Number(static_cast<std::uint16_t>(id + 1)).PrefixedText(type);
  schema.PrefixedText(SchemaEncoding(encoding)).PrefixedText(schema_text);
  ByteWriter channel;
  channel.Number(id)
      .Number(static_cast<std::uint16_t>(id + 1))
      .PrefixedText(topic)
      .PrefixedText(encoding);
  channel.Number(std::uint32_t{0});  // no metadata
  channels_.push_back({Record(kSchema, schema), Record(kChannel, channel)});
  return id;
}

void McapWriter::Write(int channel_id, Timestamp time, std::span<const std::uint8_t> data) {
  Channel& channel = channels_.at(static_cast<std::size_t>(channel_id));
  const auto id = static_cast<std::uint16_t>(channel_id);
  if (!channel.is_written) chunk_.Bytes(channel.schema_record).Bytes(channel.channel_record);
  channel.is_written = true;
  message_index_[id].emplace_back(time.ns, chunk_.size());
  ByteWriter message;
  message.Number(id).Number(static_cast<std::uint32_t>(channel.num_messages++));
  message.Number(time.ns).Number(time.ns).Bytes(data);
  chunk_.Bytes(Record(kMessage, message));
  chunk_time_.Include(time);
  time_.Include(time);
  if (!options_.has_chunks || chunk_.size() >= options_.chunk_size) FinishChunk();
}

void McapWriter::Close() {
  FinishChunk();
  ByteWriter data_end;
  data_end.Number(std::uint32_t{0});  // no checksum
  Emit(Record(kDataEnd, data_end));
  WriteSummary();
  Emit(kMagic);
  file_.close();
  if (!file_.good()) ThrowCannotWrite(path_);
}

void McapWriter::Emit(std::span<const std::uint8_t> bytes) {
  file_.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  if (!file_.good()) ThrowCannotWrite(path_);
  offset_ += bytes.size();
  crc_ = UpdateCrc(crc_, bytes);
}

void McapWriter::FinishChunk() {
  if (chunk_.size() == 0) return;
  if (!options_.has_chunks) {
    Emit(chunk_.bytes());
  } else {
    const std::vector<std::uint8_t> packed = Compress(chunk_.bytes(), options_.compression);
    ByteWriter chunk;
    chunk.Number(chunk_time_.begin.ns)
        .Number(chunk_time_.end.ns)
        .Number(std::uint64_t{chunk_.size()});
    chunk.Number(options_.has_checksums ? UpdateCrc(0, chunk_.bytes()) : 0);
    chunk.PrefixedText(NameOf(options_.compression))
        .Number(std::uint64_t{packed.size()})
        .Bytes(packed);
    ChunkIndex& index = chunks_.emplace_back();
    index.begin = offset_;
    Emit(Record(kChunk, chunk));
    index.length = offset_ - index.begin;
    index.packed_size = packed.size();
    index.size = chunk_.size();
    index.time = chunk_time_;
    if (options_.has_message_index) WriteMessageIndex(index);
  }
  message_index_.clear();
  chunk_.Clear();
  chunk_time_ = {};
}

void McapWriter::WriteMessageIndex(ChunkIndex& index) {
  const std::uint64_t begin = offset_;
  for (const auto& [channel, entries] : message_index_) {
    ByteWriter record;
    record.Number(channel).Number(static_cast<std::uint32_t>(16 * entries.size()));
    for (const auto& [time, offset] : entries) record.Number(time).Number(offset);
    index.index_offsets[channel] = offset_;
    Emit(Record(kMessageIndex, record));
  }
  index.index_length = offset_ - begin;
}

void McapWriter::WriteSummary() {
  const std::uint64_t summary_begin = offset_;
  crc_ = 0;
  if (options_.has_summary) {
    for (const Channel& channel : channels_) Emit(channel.schema_record);
    for (const Channel& channel : channels_) Emit(channel.channel_record);
    for (const ChunkIndex& chunk : chunks_) {
      ByteWriter record;
      record.Number(chunk.time.begin.ns)
          .Number(chunk.time.end.ns)
          .Number(chunk.begin)
          .Number(chunk.length);
      record.Number(static_cast<std::uint32_t>(10 * chunk.index_offsets.size()));
      for (const auto& [channel, offset] : chunk.index_offsets)
        record.Number(channel).Number(offset);
      record.Number(chunk.index_length).PrefixedText(NameOf(options_.compression));
      record.Number(chunk.packed_size).Number(chunk.size);
      Emit(Record(kChunkIndex, record));
    }
    std::uint64_t num_messages = 0;
    ByteWriter counts;
    for (std::size_t id = 0; id < channels_.size(); ++id) {
      counts.Number(static_cast<std::uint16_t>(id)).Number(channels_[id].num_messages);
      num_messages += channels_[id].num_messages;
    }
    ByteWriter statistics;
    statistics.Number(num_messages).Number(static_cast<std::uint16_t>(channels_.size()));
    statistics.Number(static_cast<std::uint32_t>(channels_.size()))
        .Number(std::uint32_t{0})
        .Number(std::uint32_t{0});
    statistics.Number(static_cast<std::uint32_t>(chunks_.size()));
    statistics.Number(time_.IsEmpty() ? 0 : time_.begin.ns)
        .Number(time_.IsEmpty() ? 0 : time_.end.ns);
    statistics.Number(static_cast<std::uint32_t>(counts.size())).Bytes(counts.bytes());
    Emit(Record(kStatistics, statistics));
  }
  ByteWriter footer;  // its checksum covers the summary and the footer up to the checksum itself
  footer.Number(static_cast<std::uint8_t>(kFooter)).Number(std::uint64_t{20});
  footer.Number(options_.has_summary ? summary_begin : 0).Number(std::uint64_t{0});
  const std::uint32_t crc = options_.has_checksums ? UpdateCrc(crc_, footer.bytes()) : 0;
  Emit(footer.Number(crc).bytes());
}

}  // namespace parkade
