#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "server/ingest/containers/log_format.h"

namespace parkade {
namespace {

// Operations and fields of wiki.ros.org/Bags/Format/2.0. A record is a header of "name=value"
// fields and data, each with its length in front.
enum Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

constexpr std::uint64_t kMagicSize = 13;        // "#ROSBAG V2.0\n"
constexpr std::uint64_t kMaxHeaderSize = 8192;  // holds a topic's name at most
constexpr std::uint64_t kIndexEntrySize = 12;

struct Field {
  std::string_view name;
  std::span<const std::uint8_t> value;
};

/// The field at the front of `bytes`, or nothing when there can be none.
std::optional<Field> ParseField(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4) return std::nullopt;
  const auto size = LoadNumber<std::uint32_t>(bytes);
  if (size > bytes.size() - 4) return std::nullopt;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + 4, size);
  const std::size_t equals = text.substr(0, 64).find('=');
  if (equals == 0 || equals == std::string_view::npos) return std::nullopt;
  const std::string_view name = text.substr(0, equals);
  const auto is_name_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  if (!std::all_of(name.begin(), name.end(), is_name_letter)) return std::nullopt;
  return Field{name, bytes.subspan(4 + equals + 1, size - equals - 1)};
}

std::size_t SizeOf(const Field& field) { return 4 + field.name.size() + 1 + field.value.size(); }

/// The header of a record: a list of fields that fills its bytes exactly.
class Header {
 public:
  static std::optional<Header> Parse(std::span<const std::uint8_t> bytes) {
    for (std::size_t offset = 0; offset < bytes.size();) {
      const auto field = ParseField(bytes.subspan(offset));
      if (!field) return std::nullopt;
      offset += SizeOf(*field);
    }
    return Header(bytes);
  }

  std::optional<std::string_view> Text(std::string_view name) const {
    for (std::size_t offset = 0; offset < bytes_.size();) {
      const auto field = ParseField(bytes_.subspan(offset));
      if (field->name == name)
        return std::string_view(reinterpret_cast<const char*>(field->value.data()),
                                field->value.size());
      offset += SizeOf(*field);
    }
    return std::nullopt;
  }

  template <typename T>
  std::optional<T> Number(std::string_view name) const {
    const auto text = Text(name);
    if (!text || text->size() != sizeof(T)) return std::nullopt;
    return LoadNumber<T>({reinterpret_cast<const std::uint8_t*>(text->data()), text->size()});
  }

 private:
  explicit Header(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::span<const std::uint8_t> bytes_;
};

/// ROS time: seconds in the lower, nanoseconds in the upper 32 bits.
Timestamp TimeFrom(std::uint64_t bits) {
  return {static_cast<std::int64_t>(bits & 0xFFFFFFFF) * 1'000'000'000 +
          static_cast<std::int64_t>(bits >> 32)};
}

bool ParseMessage(const Header& header, LogRecord& record) {
  const auto channel = header.Number<std::uint32_t>("conn");
  const auto time = header.Number<std::uint64_t>("time");
  if (!channel || !time) return false;
  record.kind = RecordKind::kMessage;
  record.channel = *channel;
  record.time = TimeFrom(*time);
  return true;
}

bool ParseChunk(const Header& header, LogRecord& record) {
  const auto name = header.Text("compression");
  const auto size = header.Number<std::uint32_t>("size");
  const auto compression = CompressionNamed(name.value_or("?"));
  if (!compression || !size || *compression == ChunkCompression::kZstd) return false;
  record.kind = RecordKind::kChunk;
  record.compression = *compression;
  record.unpacked_size = *size;
  record.is_exact = *compression == ChunkCompression::kNone && record.data_size == *size;
  record.is_unmistakable = true;
  return true;
}

bool ParseIndex(const Header& header, LogRecord& record) {
  const auto channel = header.Number<std::uint32_t>("conn");
  const auto count = header.Number<std::uint32_t>("count");
  if (!channel || !count) return false;
  record.kind = RecordKind::kChunkIndex;
  record.channel = *channel;
  record.num_entries = record.data_size / kIndexEntrySize;
  record.is_exact = record.data_size == kIndexEntrySize * *count;
  return true;
}

class Rosbag1LogFormat : public LogFormat {
 public:
  std::string name() const override { return "ROS 1 bag"; }
  std::uint64_t FirstRecord() const override { return kMagicSize; }
  std::uint64_t EndOfRecords(const InputFile& file) const override { return file.size(); }

  std::optional<LogRecord> Parse(ByteReader& reader, std::uint64_t offset) const override {
    const auto header_size = ReadNumber<std::uint32_t>(reader, offset);
    if (!header_size || *header_size < 8 || *header_size > kMaxHeaderSize) return std::nullopt;
    const std::span<const std::uint8_t> bytes = reader.Fetch(offset, 4 + *header_size + 4);
    if (bytes.size() < 4 + *header_size + 4) return std::nullopt;
    const auto header = Header::Parse(bytes.subspan(4, *header_size));
    const auto op = header ? header->Number<std::uint8_t>("op") : std::nullopt;
    if (!op) return std::nullopt;

    LogRecord record;
    record.begin = offset;
    record.data_begin = offset + bytes.size();
    record.data_size = LoadNumber<std::uint32_t>(bytes.last(4));
    record.end = record.data_begin + record.data_size;
    if (*op == kMessage)
      return ParseMessage(*header, record) ? std::optional(record) : std::nullopt;
    if (*op == kChunk) return ParseChunk(*header, record) ? std::optional(record) : std::nullopt;
    if (record.end > reader.size()) return std::nullopt;
    if (*op == kIndex) return ParseIndex(*header, record) ? std::optional(record) : std::nullopt;
    if (*op == kConnection) record.kind = RecordKind::kDefinition;
    if (*op == kChunkInfo)
      record.is_exact = record.data_size == 8 * header->Number<std::uint32_t>("count").value_or(0);
    return record;
  }

  std::size_t FindCandidate(std::span<const std::uint8_t> bytes, std::size_t begin) const override {
    for (std::size_t i = begin; i + 16 <= bytes.size(); ++i) {
      // Header and first field are shorter than 64 KiB; the field's name begins with a letter.
      if (bytes[i + 2] != 0 || bytes[i + 3] != 0 || bytes[i + 6] != 0 || bytes[i + 7] != 0)
        continue;
      if (bytes[i + 8] >= 'a' && bytes[i + 8] <= 'z') return i;
    }
    return bytes.size();
  }

  void Learn(ByteReader& reader, const LogRecord& record, ChannelTable& channels) const override;

  void ReadIndex(ByteReader& reader, const LogRecord& record,
                 const std::function<void(const ChunkIndexEntry&)>& add) const override {
    for (std::uint64_t i = 0; i < record.num_entries; ++i) {
      const std::span<const std::uint8_t> entry =
          reader.Fetch(record.data_begin + kIndexEntrySize * i, 12);
      if (entry.size() < kIndexEntrySize) return;
      add({TimeFrom(LoadNumber<std::uint64_t>(entry)),
           LoadNumber<std::uint32_t>(entry.subspan(8))});
    }
  }

  LogSummary ReadSummary(const InputFile& file, ChannelTable& channels) const override;

 private:
  /// The header's fields of the record at `offset`; valid until the reader's next call.
  static std::optional<Header> HeaderAt(ByteReader& reader, std::uint64_t offset) {
    const auto size = ReadNumber<std::uint32_t>(reader, offset);
    if (!size || *size > kMaxHeaderSize) return std::nullopt;
    const std::span<const std::uint8_t> bytes = reader.Fetch(offset + 4, *size);
    return bytes.size() == *size ? Header::Parse(bytes) : std::nullopt;
  }
};

void Rosbag1LogFormat::Learn(ByteReader& reader, const LogRecord& record,
                             ChannelTable& channels) const {
  ChannelTable::Channel channel;
  channel.encoding = "ros1";
  const auto header = HeaderAt(reader, record.begin);
  const auto id = header ? header->Number<std::uint32_t>("conn") : std::nullopt;
  const auto topic = header ? header->Text("topic") : std::nullopt;
  if (!id || !topic) return;
  channel.topic = *topic;
  // The data are fields, too.
  for (std::uint64_t offset = record.data_begin; offset < record.end;) {
    constexpr std::uint64_t kMaxText = std::uint64_t{1} << 18;
    constexpr std::string_view kDefinition = "message_definition=";
    const auto size = ReadNumber<std::uint32_t>(reader, offset);
    if (!size || *size > record.end - offset) return;
    const auto text = ReadText(reader, offset + 4, *size, kMaxText);
    if (text && text->starts_with("type=")) channel.type = text->substr(5);
    if (text && text->starts_with(kDefinition))
      channel.definition = std::make_shared<const std::string>(text->substr(kDefinition.size()));
    offset += 4 + std::uint64_t{*size};
  }
  if (!channel.type.empty()) channels.AddChannel(*id, channel);
}

LogSummary Rosbag1LogFormat::ReadSummary(const InputFile& file, ChannelTable& channels) const {
  LogSummary summary;
  FileReader reader(file, file.size());
  const auto header = HeaderAt(reader, kMagicSize);
  if (!header || header->Number<std::uint8_t>("op") != kBagHeader) return summary;
  Require(header->Text("encryptor").value_or("").empty(), ErrorCode::kInvalidInput,
          "'" + file.name() + "' is encrypted: decrypt it with rosbag decompress");
  const std::uint64_t index_begin = header->Number<std::uint64_t>("index_pos").value_or(0);
  const std::uint32_t num_connections = header->Number<std::uint32_t>("conn_count").value_or(0);
  const std::uint32_t num_chunks = header->Number<std::uint32_t>("chunk_count").value_or(0);
  if (index_begin < kMagicSize || index_begin > file.size()) return summary;
  std::uint64_t offset = index_begin;
  std::uint64_t num_found_connections = 0, num_found_chunks = 0;
  while (offset < file.size()) {
    const auto record = Parse(reader, offset);
    if (!record) return summary;
    const auto op = HeaderAt(reader, offset)->Number<std::uint8_t>("op");
    if (op == kConnection) {
      Learn(reader, *record, channels);
      ++num_found_connections;
    } else if (op == kChunkInfo) {
      ++num_found_chunks;
    } else {
      return summary;
    }
    offset = record->end;
  }
  summary.is_closed = num_found_connections >= num_connections && num_found_chunks >= num_chunks;
  if (summary.is_closed) summary.num_channels = num_connections;
  return summary;
}

}  // namespace

const LogFormat& Rosbag1Format() {
  static const Rosbag1LogFormat format;
  return format;
}

}  // namespace parkade
