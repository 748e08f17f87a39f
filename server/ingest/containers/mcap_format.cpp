#include <algorithm>
#include <array>
#include <limits>

#include "server/ingest/containers/log_format.h"
#include "server/ingest/writing/mcap_records.h"

namespace parkade {
namespace {

using Opcode = McapRecord::Opcode;
using enum McapRecord::Opcode;

constexpr const auto& kMagic = McapRecord::kMagic;
constexpr std::uint64_t kPrefixSize = 9;   // opcode, length
constexpr std::uint64_t kFooterSize = 20;  // without prefix

// Fields of a record's body: a positive number counts fixed bytes.
constexpr int kEnd = 0;
constexpr int kText = -1;  // 32-bit length in front: texts, arrays and maps
constexpr int kBlob = -2;  // 64-bit length in front

struct Layout {
  Opcode opcode;
  std::array<int, 6> fields;
};

constexpr Layout kLayouts[] = {
    {kHeader, {kText, kText}},
    {kFooter, {kFooterSize}},
    {kSchema, {2, kText, kText, kText}},
    {kChannel, {4, kText, kText, kText}},
    {kMessage, {22}},
    {kChunk, {28, kText, kBlob}},
    {kMessageIndex, {2, kText}},
    {kChunkIndex, {32, kText, 8, kText, 16}},
    {kAttachment, {16, kText, kText, kBlob, 4}},
    {kAttachmentIndex, {40, kText, kText}},
    {kStatistics, {42, kText}},
    {kMetadata, {kText, kText}},
    {kMetadataIndex, {16, kText}},
    {kSummaryOffset, {17}},
    {kDataEnd, {4}},
};

Timestamp TimeFrom(std::uint64_t ns) {
  constexpr auto kLatest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return {static_cast<std::int64_t>(std::min(ns, kLatest))};
}

/// Bytes that the fields of a body take by their own lengths; nothing when they do not fit in
/// `length`.
std::optional<std::uint64_t> MeasureFields(ByteReader& reader, const Layout& layout,
                                           std::uint64_t body, std::uint64_t length) {
  std::uint64_t size = 0;
  for (const int field : layout.fields) {
    if (field == kEnd) break;
    if (field > 0) {
      size += static_cast<std::uint64_t>(field);
    } else {
      const std::uint64_t width = field == kText ? 4 : 8;
      if (size + width > length) return std::nullopt;
      std::optional<std::uint64_t> count;
      if (field == kText) {
        count = ReadNumber<std::uint32_t>(reader, body + size);
      } else {
        count = ReadNumber<std::uint64_t>(reader, body + size);
      }
      if (!count || *count > length - size - width) return std::nullopt;
      size += width + *count;
    }
    if (size > length) return std::nullopt;
  }
  return size;
}

/// Fills in the fields of a chunk's header. False when it cannot be one. Its two lengths may
/// contradict each other: then one of them is damaged, and the record is not exact.
bool ParseChunk(ByteReader& reader, std::uint64_t length, LogRecord& record) {
  const std::span<const std::uint8_t> head = reader.Fetch(record.begin + kPrefixSize, 44);
  if (head.size() < 40) return false;
  record.kind = RecordKind::kChunk;
  const Timestamp first = TimeFrom(LoadNumber<std::uint64_t>(head));
  const Timestamp last = TimeFrom(LoadNumber<std::uint64_t>(head.subspan(8)));
  if (first.ns != 0 || last.ns != 0) {
    record.span.Include(first);
    record.span.Include(last);
  }
  record.unpacked_size = LoadNumber<std::uint64_t>(head.subspan(16));
  const auto checksum = LoadNumber<std::uint32_t>(head.subspan(24));
  if (checksum != 0) record.checksum = checksum;  // 0: not available
  const auto name_size = LoadNumber<std::uint32_t>(head.subspan(28));
  if (name_size > 4 || head.size() < 40 + name_size) return false;
  const auto compression = CompressionNamed(
      {reinterpret_cast<const char*>(head.data()) + 32, static_cast<std::size_t>(name_size)});
  if (!compression || *compression == ChunkCompression::kBz2) return false;
  record.compression = *compression;
  record.data_size = LoadNumber<std::uint64_t>(head.subspan(32 + name_size));
  record.data_begin = record.begin + kPrefixSize + 40 + name_size;
  record.is_exact = record.data_size == length - 40 - name_size && length >= 40 + name_size &&
                    (name_size > 0 || record.data_size == record.unpacked_size);
  record.is_unmistakable = record.is_exact;
  return true;
}

bool ParseMessage(ByteReader& reader, std::uint64_t length, LogRecord& record) {
  const std::span<const std::uint8_t> head = reader.Fetch(record.begin + kPrefixSize, 14);
  if (length < 22 || head.size() < 14) return false;
  record.kind = RecordKind::kMessage;
  record.channel = LoadNumber<std::uint16_t>(head);
  record.time = TimeFrom(LoadNumber<std::uint64_t>(head.subspan(6)));
  record.data_begin = record.begin + kPrefixSize + 22;
  record.data_size = length - 22;
  return true;
}

bool ParseMessageIndex(ByteReader& reader, std::uint64_t length, LogRecord& record) {
  constexpr std::uint64_t kEntrySize = 16;
  if (length < 6 || (length - 6) % kEntrySize != 0) return false;
  const auto channel = ReadNumber<std::uint16_t>(reader, record.begin + kPrefixSize);
  if (!channel) return false;
  record.kind = RecordKind::kChunkIndex;
  record.channel = *channel;
  record.data_begin = record.begin + kPrefixSize + 6;
  record.data_size = length - 6;
  record.num_entries = record.data_size / kEntrySize;
  return true;
}

std::uint32_t CrcOf(ByteReader& reader, std::uint64_t begin, std::uint64_t end) {
  constexpr std::uint64_t kStep = 65536;
  std::uint32_t crc = 0;
  for (std::uint64_t offset = begin; offset < end; offset += kStep)
    crc = UpdateCrc32(
        crc, reader.Fetch(offset, static_cast<std::size_t>(std::min(kStep, end - offset))));
  return crc;
}

class McapLogFormat : public LogFormat {
 public:
  std::string name() const override { return "MCAP"; }
  std::uint64_t FirstRecord() const override { return kMagic.size(); }

  std::uint64_t EndOfRecords(const InputFile& file) const override {
    return HasEndMagic(file) ? file.size() - kMagic.size() : file.size();
  }

  std::optional<LogRecord> Parse(ByteReader& reader, std::uint64_t offset) const override {
    const std::span<const std::uint8_t> prefix = reader.Fetch(offset, kPrefixSize);
    if (prefix.size() < kPrefixSize) return std::nullopt;
    const std::uint8_t opcode = prefix[0];
    const auto length = LoadNumber<std::uint64_t>(prefix.subspan(1));
    constexpr std::uint64_t kLongest = std::uint64_t{1} << 48;  // keeps sums far from overflow
    if (opcode == 0 || length > kLongest) return std::nullopt;

    LogRecord record;
    record.begin = offset;
    record.end = offset + kPrefixSize + length;
    record.data_begin = offset + kPrefixSize;
    record.data_size = length;
    if (opcode == kChunk)
      return ParseChunk(reader, length, record) ? std::optional(record) : std::nullopt;
    if (opcode == kMessage)
      return ParseMessage(reader, length, record) ? std::optional(record) : std::nullopt;
    if (record.end > reader.size()) return std::nullopt;
    if (opcode > std::size(kLayouts)) {
      record.kind = RecordKind::kUnknown;
      return record;
    }
    const Layout& layout = kLayouts[opcode - 1];
    const auto size = MeasureFields(reader, layout, record.data_begin, length);
    if (!size) return std::nullopt;
    record.is_exact = *size == length;
    if (opcode == kSchema || opcode == kChannel) record.kind = RecordKind::kDefinition;
    if (opcode == kMessageIndex && !ParseMessageIndex(reader, length, record)) return std::nullopt;
    return record;
  }

  std::size_t FindCandidate(std::span<const std::uint8_t> bytes, std::size_t begin) const override {
    for (std::size_t i = begin; i + 16 <= bytes.size(); ++i) {
      const std::uint8_t opcode = bytes[i];
      if (opcode == 0 || opcode > std::size(kLayouts)) continue;
      if ((LoadNumber<std::uint64_t>(bytes.subspan(i + 1, 8)) >> 40) == 0) return i;
    }
    return bytes.size();
  }

  void Learn(ByteReader& reader, const LogRecord& record, ChannelTable& channels) const override;

  void ReadIndex(ByteReader& reader, const LogRecord& record,
                 const std::function<void(const ChunkIndexEntry&)>& add) const override {
    for (std::uint64_t i = 0; i < record.num_entries; ++i) {
      const std::span<const std::uint8_t> entry = reader.Fetch(record.data_begin + 16 * i, 16);
      if (entry.size() < 16) return;
      add({TimeFrom(LoadNumber<std::uint64_t>(entry)),
           LoadNumber<std::uint64_t>(entry.subspan(8))});
    }
  }

  LogSummary ReadSummary(const InputFile& file, ChannelTable& channels) const override;

 private:
  static bool HasEndMagic(const InputFile& file) {
    std::array<std::uint8_t, kMagic.size()> end{};
    return file.size() >= 2 * kMagic.size() &&
           file.ReadAt(file.size() - end.size(), end) == end.size() && end == kMagic;
  }
  /// What follows a schema's name: its encoding and its text. Null where that is damaged, or too
  /// long to be true.
  static std::shared_ptr<const std::string> SchemaText(ByteReader& reader, const LogRecord& record,
                                                       std::uint64_t encoding_begin);
  static void ReadStatistics(ByteReader& reader, const LogRecord& record, LogSummary& summary);
};

void McapLogFormat::Learn(ByteReader& reader, const LogRecord& record,
                          ChannelTable& channels) const {
  constexpr std::uint64_t kMaxText = 4096;
  const bool is_schema = reader.Fetch(record.begin, 1).front() == kSchema;
  const auto id = ReadNumber<std::uint16_t>(reader, record.data_begin);
  const auto schema = ReadNumber<std::uint16_t>(reader, record.data_begin + 2);
  const std::uint64_t name_begin = record.data_begin + (is_schema ? 2 : 4);
  const auto name_size = ReadNumber<std::uint32_t>(reader, name_begin);
  if (!id || !schema || !name_size) return;
  const auto name = ReadText(reader, name_begin + 4, *name_size, kMaxText);
  if (!name) return;
  if (is_schema)
    return channels.AddSchema(*id,
                              {*name, SchemaText(reader, record, name_begin + 4 + *name_size)});
  const std::uint64_t encoding_begin = name_begin + 4 + *name_size;
  const auto encoding_size = ReadNumber<std::uint32_t>(reader, encoding_begin);
  if (!encoding_size) return;
  const auto encoding = ReadText(reader, encoding_begin + 4, *encoding_size, kMaxText);
  if (encoding) channels.AddChannel(*id, {*name, "", *encoding, *schema});
}

std::shared_ptr<const std::string> McapLogFormat::SchemaText(ByteReader& reader,
                                                             const LogRecord& record,
                                                             std::uint64_t encoding_begin) {
  constexpr std::uint64_t kMaxSchema = std::uint64_t{1} << 18;
  const auto encoding_size = ReadNumber<std::uint32_t>(reader, encoding_begin);
  if (!encoding_size || *encoding_size > record.data_size) return nullptr;
  const std::uint64_t text_begin = encoding_begin + 4 + *encoding_size;
  const auto text_size = ReadNumber<std::uint32_t>(reader, text_begin);
  if (!text_size || text_begin + 4 + *text_size > record.end) return nullptr;
  auto text = ReadText(reader, text_begin + 4, *text_size, kMaxSchema);
  return text ? std::make_shared<const std::string>(std::move(*text)) : nullptr;
}

LogSummary McapLogFormat::ReadSummary(const InputFile& file, ChannelTable& channels) const {
  LogSummary summary;
  const std::uint64_t tail = kPrefixSize + kFooterSize + kMagic.size();
  if (!HasEndMagic(file) || file.size() < kMagic.size() + tail) return summary;
  FileReader reader(file, file.size() - kMagic.size());
  const std::uint64_t footer_begin = file.size() - tail;
  const std::span<const std::uint8_t> footer =
      reader.Fetch(footer_begin, kPrefixSize + kFooterSize);
  if (footer.size() < kPrefixSize + kFooterSize || footer[0] != kFooter ||
      LoadNumber<std::uint64_t>(footer.subspan(1)) != kFooterSize)
    return summary;
  summary.is_closed = true;
  const auto begin = LoadNumber<std::uint64_t>(footer.subspan(kPrefixSize));
  const auto claimed_crc = LoadNumber<std::uint32_t>(footer.subspan(kPrefixSize + 16));
  if (begin == 0) return summary;
  const bool is_sound =
      begin >= FirstRecord() && begin <= footer_begin &&
      (claimed_crc == 0 || claimed_crc == CrcOf(reader, begin, footer_begin + kPrefixSize + 16));
  if (!is_sound) summary.problem = "the summary at the end of the file has a wrong checksum";
  for (std::uint64_t offset = begin; is_sound && offset < footer_begin;) {
    const auto record = Parse(reader, offset);
    if (!record || record->end > footer_begin) {
      summary.num_channels.reset();
      break;
    }
    if (record->kind == RecordKind::kDefinition) Learn(reader, *record, channels);
    if (reader.Fetch(offset, 1).front() == kStatistics) ReadStatistics(reader, *record, summary);
    offset = record->end;
  }
  return summary;
}

void McapLogFormat::ReadStatistics(ByteReader& reader, const LogRecord& record,
                                   LogSummary& summary) {
  const auto num_channels = ReadNumber<std::uint32_t>(reader, record.data_begin + 10);
  const auto counts_size = ReadNumber<std::uint32_t>(reader, record.data_begin + 42);
  if (!num_channels || !counts_size) return;
  summary.num_channels = *num_channels;
  for (std::uint64_t i = 0; i + 10 <= *counts_size; i += 10) {
    const auto channel = ReadNumber<std::uint16_t>(reader, record.data_begin + 46 + i);
    const auto count = ReadNumber<std::uint64_t>(reader, record.data_begin + 48 + i);
    if (channel && count) summary.num_messages[*channel] = *count;
  }
}

}  // namespace

const LogFormat& McapFormat() {
  static const McapLogFormat format;
  return format;
}

}  // namespace parkade
