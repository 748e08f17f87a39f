#include "tests/support/rosbag1_writer.h"

#include "core/error.h"

namespace parkade {
namespace {

enum Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

constexpr std::size_t kBagHeaderSize = 4096;  // padded, so that it can be written again at the end

/// The fields of a record's header.
class Header {
 public:
  explicit Header(Op op) { Field("op", ByteWriter().Number(static_cast<std::uint8_t>(op))); }
  Header() = default;

  Header& Field(std::string_view name, const ByteWriter& value) {
    bytes_.Number(static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    bytes_.Text(name).Text("=").Bytes(value.bytes());
    return *this;
  }
  template <typename T>
  Header& Number(std::string_view name, T value) {
    return Field(name, ByteWriter().Number(value));
  }
  Header& Text(std::string_view name, std::string_view value) {
    return Field(name, ByteWriter().Text(value));
  }
  Header& Time(std::string_view name, Timestamp time);

  const std::vector<std::uint8_t>& bytes() const { return bytes_.bytes(); }

 private:
  ByteWriter bytes_;
};

/// ROS time: seconds and nanoseconds, 32 bits each.
ByteWriter RosTime(Timestamp time) {
  ByteWriter bytes;
  bytes.Number(static_cast<std::uint32_t>(time.ns / 1'000'000'000));
  bytes.Number(static_cast<std::uint32_t>(time.ns % 1'000'000'000));
  return bytes;
}

Header& Header::Time(std::string_view name, Timestamp time) { return Field(name, RosTime(time)); }

std::vector<std::uint8_t> Record(const Header& header, std::span<const std::uint8_t> data) {
  ByteWriter record;
  record.Number(static_cast<std::uint32_t>(header.bytes().size())).Bytes(header.bytes());
  record.Number(static_cast<std::uint32_t>(data.size())).Bytes(data);
  return record.bytes();
}

const char* BagNameOf(LogCompression compression) {
  return compression == LogCompression::kNone ? "none" : NameOf(compression);
}

}  // namespace

Rosbag1Writer::Rosbag1Writer(const std::filesystem::path& file, const Rosbag1WriterOptions& options)
    : options_(options), name_(file.filename().string()), file_(file, std::ios::binary) {
  Require(options.compression != LogCompression::kZstd, ErrorCode::kInternal,
          "ROS 1 bags know no zstd");
  Emit(ByteWriter().Text("#ROSBAG V2.0\n").bytes());
  EmitBagHeader(/*index_begin=*/0);
}

int Rosbag1Writer::AddChannel(const std::string& topic, const std::string& type,
                              const std::string& definition, const std::string& md5sum) {
  const int id = static_cast<int>(channels_.size());
  Header connection;
  connection.Text("topic", topic)
      .Text("type", type)
      .Text("md5sum", md5sum)
      .Text("message_definition", definition);
  const Header header =
      Header(kConnection).Number("conn", static_cast<std::uint32_t>(id)).Text("topic", topic);
  channels_.push_back({Record(header, connection.bytes())});
  return id;
}

void Rosbag1Writer::Write(int channel_id, Timestamp time, std::span<const std::uint8_t> data) {
  Channel& channel = channels_.at(static_cast<std::size_t>(channel_id));
  const auto id = static_cast<std::uint32_t>(channel_id);
  if (!channel.is_written) chunk_.Bytes(channel.record);
  channel.is_written = true;
  index_[id].push_back({time, static_cast<std::uint32_t>(chunk_.size())});
  chunk_.Bytes(Record(Header(kMessage).Number("conn", id).Time("time", time), data));
  chunk_time_.Include(time);
  if (chunk_.size() >= options_.chunk_size) FinishChunk();
}

void Rosbag1Writer::Close() {
  FinishChunk();
  const std::uint64_t index_begin = offset_;
  for (const Channel& channel : channels_) Emit(channel.record);
  for (const ChunkInfo& chunk : chunks_) {
    Header header(kChunkInfo);
    header.Number("ver", std::uint32_t{1}).Number("chunk_pos", chunk.begin);
    header.Time("start_time", chunk.time.begin).Time("end_time", chunk.time.end);
    header.Number("count", static_cast<std::uint32_t>(chunk.num_messages.size()));
    ByteWriter counts;
    for (const auto& [channel, count] : chunk.num_messages) counts.Number(channel).Number(count);
    Emit(Record(header, counts.bytes()));
  }
  file_.seekp(13);
  EmitBagHeader(index_begin);
  file_.close();
  Require(file_.good(), ErrorCode::kInternal, "cannot write '" + name_ + "'");
}

void Rosbag1Writer::Emit(std::span<const std::uint8_t> bytes) {
  file_.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  Require(file_.good(), ErrorCode::kInternal, "cannot write '" + name_ + "'");
  offset_ += bytes.size();
}

void Rosbag1Writer::EmitBagHeader(std::uint64_t index_begin) {
  Header header(kBagHeader);
  header.Number("index_pos", index_begin)
      .Number("conn_count", static_cast<std::uint32_t>(channels_.size()));
  header.Number("chunk_count", static_cast<std::uint32_t>(chunks_.size()));
  const std::vector<std::uint8_t> padding(kBagHeaderSize - 8 - header.bytes().size(), ' ');
  Emit(Record(header, padding));
}

void Rosbag1Writer::FinishChunk() {
  if (chunk_.size() == 0) return;
  ChunkInfo& info = chunks_.emplace_back();
  info.begin = offset_;
  info.time = chunk_time_;
  Header header(kChunk);
  header.Text("compression", BagNameOf(options_.compression));
  header.Number("size", static_cast<std::uint32_t>(chunk_.size()));
  Emit(Record(header, Compress(chunk_.bytes(), options_.compression)));
  for (const auto& [channel, entries] : index_) {
    info.num_messages[channel] = static_cast<std::uint32_t>(entries.size());
    Header index(kIndex);
    index.Number("ver", std::uint32_t{1}).Number("conn", channel);
    index.Number("count", static_cast<std::uint32_t>(entries.size()));
    ByteWriter data;
    for (const Entry& entry : entries) data.Bytes(RosTime(entry.time).bytes()).Number(entry.offset);
    Emit(Record(index, data.bytes()));
  }
  index_.clear();
  chunk_.Clear();
  chunk_time_ = {};
}

}  // namespace parkade
