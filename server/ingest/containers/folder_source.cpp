#include "server/ingest/containers/folder_source.h"

#include <limits>

#include "core/error.h"
#include "server/ingest/containers/damage.h"
#include "server/ingest/files/folder_rows.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// One stream, one row ahead so that a stamp out of line with its neighbors does not hold up or
/// overtake the others.
class StreamReader {
 public:
  StreamReader(const FolderStream& stream, int topic, std::uint64_t place = 0)
      : rows_(OpenRows(stream, place)), topic_(topic) {
    next_ = rows_->Next();
    Advance();
  }

  bool is_done() const { return !current_; }
  Timestamp order() const { return order_; }
  const BadLines& bad_lines() const { return rows_->bad_lines(); }
  int topic() const { return topic_; }

  RawMessage Take() {
    RawMessage message{topic_, current_->stamp, {}, {current_->offset}};
    message.data.assign(current_->text.begin(), current_->text.end());
    Advance();
    return message;
  }

 private:
  void Advance() {
    current_ = std::move(next_);
    if (!current_) return;
    next_ = rows_->Next();
    const bool is_in_line = !next_ || current_->stamp <= next_->stamp;
    if (is_in_line && current_->stamp > order_) order_ = current_->stamp;
  }

  std::unique_ptr<FolderRows> rows_;
  int topic_;
  std::optional<EurocLine> current_, next_;
  Timestamp order_{std::numeric_limits<std::int64_t>::min()};
};

class FolderPass : public MessageStream {
 public:
  FolderPass(const FolderSource& source, const std::vector<bool>& wanted)
      : folder_(source.folder().path),
        streams_(source.streams()),
        archive_damage_(source.archive_damage()) {
    for (std::size_t i = 0; i < streams_.size(); ++i)
      if (wanted[i])
        readers_.push_back(std::make_unique<StreamReader>(streams_[i], static_cast<int>(i)));
  }

  std::optional<RawMessage> Next() override {
    StreamReader* first = nullptr;
    for (const auto& reader : readers_)
      if (!reader->is_done() && (!first || reader->order() < first->order())) first = reader.get();
    if (!first) {
      ReportDamage();
      return std::nullopt;
    }
    return first->Take();
  }

  const DamageReport& damage() const override { return damage_; }

 private:
  void ReportDamage() {
    damage_ = {};
    AddArchiveDamage(damage_, archive_damage_);
    for (const auto& reader : readers_) {
      const BadLines& bad = reader->bad_lines();
      if (bad.count == 0) continue;
      const FolderStream& stream = streams_[static_cast<std::size_t>(reader->topic())];
      const std::string where = stream.index.lexically_relative(folder_).string();
      const bool is_one = bad.count == 1;
      damage_.ranges.push_back({where + " has " + std::to_string(bad.count) +
                                    (is_one ? " row that cannot be read: "
                                            : " rows that cannot be read, the first is ") +
                                    bad.first,
                                stream.topic,
                                {},
                                bad.count});
      damage_.num_lost_messages += bad.count;
    }
  }

  fs::path folder_;
  std::vector<FolderStream> streams_;
  std::string archive_damage_;
  std::vector<std::unique_ptr<StreamReader>> readers_;
  DamageReport damage_;
};

const char* TypeOf(TableKind kind) {
  switch (kind) {
    case TableKind::kImu: return "sensor_msgs/Imu";
    case TableKind::kWheels: return "geometry_msgs/TwistStamped";
    case TableKind::kGnss: return "sensor_msgs/NavSatFix";
    case TableKind::kImages: break;
  }
  return "sensor_msgs/CompressedImage";
}

/// What was assumed to read a stream; empty where it is written as EuRoC writes.
std::string RemarkOn(const FolderStream& stream, FolderLayout layout) {
  std::string remark;
  if (layout == FolderLayout::kEuroc && stream.format.unit != StampUnit::kNanoseconds)
    remark = std::string("its stamps are in ") + NameOf(stream.format.unit);
  if (!stream.format.columns.empty())
    remark += std::string(remark.empty() ? "" : ", ") + "its columns are taken by their names";
  return remark.empty() ? "" : stream.topic + ": as it seems, " + remark;
}

}  // namespace

FolderSource::FolderSource(DriveFolder folder)
    : folder_(std::move(folder)), streams_(StreamsOf(folder_)) {
  for (const FolderStream& stream : streams_)
    topics_.push_back({.topic = stream.topic,
                       .type = TypeOf(stream.kind),
                       .encoding = MessageEncoding::kEuroc,
                       .remark = RemarkOn(stream, folder_.layout)});
  Require(
      !topics_.empty(), ErrorCode::kInvalidInput,
      folder_.path.filename().string() + " holds no EuRoC stream (imu0/data.csv, cam0/data.csv)");
}

FolderSource::FolderSource(std::shared_ptr<const TemporaryFolder> unpacked, const std::string& name,
                           const std::string& damage)
    : FolderSource(FindDriveFolder(unpacked->path(), name)
                       .value_or(DriveFolder{unpacked->path(), FolderLayout::kEuroc})) {
  unpacked_ = std::move(unpacked);
  archive_damage_ = damage;
}

std::string FolderSource::format() const {
  const std::string where = unpacked_ ? "archive" : "folder";
  switch (folder_.layout) {
    case FolderLayout::kEuroc: return "EuRoC " + where;
    case FolderLayout::kKitti: return "KITTI raw " + where;
    case FolderLayout::kPlain: break;
  }
  return where + " of images and tables";
}

std::unique_ptr<MessageStream> FolderSource::Read(const std::vector<bool>& wanted) const {
  return std::make_unique<FolderPass>(*this, wanted);
}

std::optional<RawMessage> FolderSource::ReadAt(int topic, const MessagePlace& place) const {
  StreamReader reader(streams_[static_cast<std::size_t>(topic)], topic, place.record);
  if (reader.is_done()) return std::nullopt;
  RawMessage message = reader.Take();
  return message.place.record == place.record ? std::optional(std::move(message)) : std::nullopt;
}

}  // namespace parkade
