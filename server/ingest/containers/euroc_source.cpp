#include "server/ingest/containers/euroc_source.h"

#include <regex>

#include "core/error.h"
#include "server/ingest/containers/damage.h"
#include "server/ingest/files/euroc_csv.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

bool IsEurocFolder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "imu0" / "data.csv", ignored) ||
         fs::is_regular_file(folder / "cam0" / "data.csv", ignored);
}

std::vector<fs::path> SortedFolders(const fs::path& folder) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->is_directory(error)) folders.push_back(entry->path());
  // Orders names by length first, so that cam10 comes after cam2.
  std::sort(folders.begin(), folders.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(a.native().size(), a.native()) < std::pair(b.native().size(), b.native());
  });
  return folders;
}

bool IsPlainFileName(std::string_view name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string_view::npos &&
         name.find('\0') == std::string_view::npos;
}

/// One stream's file, one line ahead so that a stamp out of line with its neighbors does not hold
/// up or overtake the others.
class EurocStreamReader {
 public:
  EurocStreamReader(const fs::path& folder, bool is_image, int topic, std::uint64_t offset = 0)
      : csv_(folder / "data.csv", offset),
        data_folder_(folder / "data"),
        is_image_(is_image),
        topic_(topic) {
    next_ = csv_.Next();
    Advance();
  }

  bool is_done() const { return !current_; }
  Timestamp order() const { return order_; }
  std::uint64_t num_bad_lines() const { return csv_.num_bad_lines() + num_bad_names_; }
  int topic() const { return topic_; }

  RawMessage Take() {
    RawMessage message{topic_, current_->stamp, {}, {current_->offset}};
    const std::string content =
        is_image_ ? (data_folder_ / ImageName(*current_)).string() : current_->text;
    message.data.assign(content.begin(), content.end());
    Advance();
    return message;
  }

 private:
  static std::string ImageName(const EurocLine& line) {
    const std::vector<std::string_view> fields = SplitCsv(line.text);
    return fields.size() > 1 ? std::string(fields[1]) : std::to_string(line.stamp.ns) + ".png";
  }

  void Advance() {
    do {
      current_ = std::move(next_);
      if (!current_) return;
      next_ = csv_.Next();
      if (!is_image_ || IsPlainFileName(ImageName(*current_))) break;
      ++num_bad_names_;
    } while (true);
    const bool is_in_line = !next_ || current_->stamp <= next_->stamp;
    if (is_in_line && current_->stamp > order_) order_ = current_->stamp;
  }

  EurocCsv csv_;
  fs::path data_folder_;
  bool is_image_;
  int topic_;
  std::optional<EurocLine> current_, next_;
  Timestamp order_{std::numeric_limits<std::int64_t>::min()};
  std::uint64_t num_bad_names_ = 0;
};

bool IsImage(const TopicInfo& topic) { return topic.type == "sensor_msgs/CompressedImage"; }

class EurocStream : public MessageStream {
 public:
  EurocStream(const EurocSource& source, const std::vector<bool>& wanted)
      : topics_(source.topics()), archive_damage_(source.archive_damage()) {
    for (std::size_t i = 0; i < topics_.size(); ++i)
      if (wanted[i])
        readers_.push_back(std::make_unique<EurocStreamReader>(
            source.folder() / topics_[i].topic, IsImage(topics_[i]), static_cast<int>(i)));
  }

  std::optional<RawMessage> Next() override {
    EurocStreamReader* first = nullptr;
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
      if (reader->num_bad_lines() == 0) continue;
      const std::string& topic = topics_[static_cast<std::size_t>(reader->topic())].topic;
      const std::uint64_t count = reader->num_bad_lines();
      damage_.ranges.push_back(
          {topic + "/data.csv has " + std::to_string(count) + " lines that cannot be read",
           topic,
           {},
           count});
      damage_.num_lost_messages += count;
    }
  }

  std::vector<TopicInfo> topics_;
  std::string archive_damage_;
  std::vector<std::unique_ptr<EurocStreamReader>> readers_;
  DamageReport damage_;
};

}  // namespace

std::optional<fs::path> FindEurocFolder(const fs::path& folder) {
  constexpr int kMaxDepth = 3;
  std::vector<fs::path> level{folder};
  for (int depth = 0; depth <= kMaxDepth; ++depth) {
    std::vector<fs::path> found, below;
    for (const fs::path& candidate : level) {
      if (IsEurocFolder(candidate)) found.push_back(candidate);
      if (depth == kMaxDepth) continue;
      for (const fs::path& child : SortedFolders(candidate)) below.push_back(child);
    }
    Require(found.size() <= 1, ErrorCode::kInvalidInput,
            folder.filename().string() + " holds several EuRoC drives: give one of them");
    if (!found.empty()) return found.front();
    level = std::move(below);
  }
  return std::nullopt;
}

EurocSource::EurocSource(const fs::path& folder) : folder_(folder) {
  const auto add = [&](const std::string& topic, const std::string& type) {
    if (fs::is_regular_file(folder_ / topic / "data.csv"))
      topics_.push_back({topic, type, MessageEncoding::kEuroc, 0});
  };
  add("imu0", "sensor_msgs/Imu");
  add("odom0", "geometry_msgs/TwistStamped");
  add("gnss0", "sensor_msgs/NavSatFix");
  const std::regex camera_name("cam[0-9]{1,3}");
  for (const fs::path& child : SortedFolders(folder_)) {
    const std::string name = child.filename().string();
    if (!std::regex_match(name, camera_name)) continue;
    add(name, "sensor_msgs/CompressedImage");
    add(name + "/semantic", "sensor_msgs/CompressedImage");
  }
  Require(!topics_.empty(), ErrorCode::kInvalidInput,
          folder.filename().string() + " holds no EuRoC stream (imu0/data.csv, cam0/data.csv)");
}

EurocSource::EurocSource(std::shared_ptr<const TemporaryFolder> unpacked, const std::string& damage)
    : EurocSource(unpacked->path()) {
  unpacked_ = std::move(unpacked);
  archive_damage_ = damage;
}

std::unique_ptr<MessageStream> EurocSource::Read(const std::vector<bool>& wanted) const {
  return std::make_unique<EurocStream>(*this, wanted);
}

std::optional<RawMessage> EurocSource::ReadAt(int topic, const MessagePlace& place) const {
  const TopicInfo& info = topics_[static_cast<std::size_t>(topic)];
  EurocStreamReader reader(folder_ / info.topic, IsImage(info), topic, place.record);
  if (reader.is_done()) return std::nullopt;
  RawMessage message = reader.Take();
  return message.place.record == place.record ? std::optional(std::move(message)) : std::nullopt;
}

}  // namespace parkade
