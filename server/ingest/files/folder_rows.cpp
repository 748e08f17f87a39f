#include "server/ingest/files/folder_rows.h"

#include <algorithm>
#include <fstream>
#include <span>

#include "core/error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// What follows the last slash, of whatever system.
std::string_view FileName(std::string_view path) {
  return path.substr(path.find_last_of("/\\") + 1);
}

bool IsPlainFileName(std::string_view name) {
  return !name.empty() && name != "." && name != ".." && name.find('\0') == std::string_view::npos;
}

/// A table, or an index of images, of which only the names count: they lie in the stream's own
/// folder, wherever they were when it was written.
class TableRows : public FolderRows {
 public:
  TableRows(const FolderStream& stream, std::uint64_t place)
      : csv_(stream.index, stream.format, place), data_(stream.data) {}

  std::optional<EurocLine> Next() override {
    while (std::optional<EurocLine> line = csv_.Next()) {
      if (data_.empty()) return line;
      const std::vector<std::string_view> fields = SplitCsv(line->text);
      const std::string name(fields.size() > 1 ? FileName(fields[1])
                                               : std::string(fields[0]) + ".png");
      if (IsPlainFileName(name)) {
        line->text = (data_ / name).string();
        return line;
      }
      if (num_bad_names_++ == 0) first_bad_name_ = "'" + line->text.substr(0, 40) + "'";
    }
    return std::nullopt;
  }

  const BadLines& bad_lines() const override {
    bad_lines_ = csv_.bad_lines();
    bad_lines_.count += num_bad_names_;
    if (bad_lines_.first.empty()) bad_lines_.first = first_bad_name_;
    return bad_lines_;
  }

 private:
  EurocCsv csv_;
  fs::path data_;
  std::uint64_t num_bad_names_ = 0;
  std::string first_bad_name_;
  mutable BadLines bad_lines_;
};

/// KITTI's timestamps.txt, whose line number i is that of the file 000000000i.
class KittiRows : public FolderRows {
 public:
  KittiRows(const FolderStream& stream, std::uint64_t place)
      : stamps_(stream.index), stream_(stream), index_(place) {
    Require(stamps_.is_open(), ErrorCode::kNotFound,
            "cannot open " + stream.index.filename().string());
    std::string skipped;
    for (std::uint64_t i = 0; i < place; ++i) std::getline(stamps_, skipped);
    if (stream.kind == TableKind::kImages) extension_ = ExtensionOf(stream.data);
  }

  std::optional<EurocLine> Next() override {
    for (std::string line; std::getline(stamps_, line); ++index_) {
      line.erase(line.find_last_not_of(" \t\r") + 1);
      if (line.empty()) continue;
      const std::optional<Timestamp> stamp = ParseStamp(line, StampUnit::kSeconds);
      if (!stamp) {
        CountBad("line " + std::to_string(index_ + 1) + ", '" + line.substr(0, 40) + "'");
        continue;
      }
      if (stream_.kind == TableKind::kImages)
        return EurocLine{*stamp, (stream_.data / (Name() + extension_)).string(), index_++};
      const std::optional<std::string> numbers = ReadPacket();
      if (numbers) return EurocLine{*stamp, std::to_string(stamp->ns) + *numbers, index_++};
      CountBad("the file " + Name() + ".txt");
    }
    return std::nullopt;
  }

  const BadLines& bad_lines() const override { return bad_lines_; }

 private:
  std::string Name() const {
    constexpr std::size_t kDigits = 10;
    const std::string digits = std::to_string(index_);
    return std::string(kDigits - std::min(kDigits, digits.size()), '0') + digits;
  }

  static std::string ExtensionOf(const fs::path& data) {
    std::error_code error;
    for (fs::directory_iterator entry(data, error), end; !error && entry != end;
         entry.increment(error))
      if (IsStampedImage(entry->path().filename().string())) return entry->path().extension();
    return ".png";
  }

  /// The numbers of a packet of the inertial system in EuRoC's order, each behind a comma. What is
  /// called x, y, z hangs on the car; what is called f, l, u stays level with the ground.
  std::optional<std::string> ReadPacket() const {
    constexpr std::size_t kMaxSize = 4096, kLatitude = 0, kForwardSpeed = 8, kAcceleration = 11,
                          kRate = 17, kAccuracy = 23, kNumNumbers = 24;
    const fs::path file = stream_.data / (Name() + ".txt");
    if (!fs::is_regular_file(file)) return std::nullopt;
    std::ifstream stream(file);
    std::string text(kMaxSize, '\0');
    stream.read(text.data(), kMaxSize);
    text.resize(static_cast<std::size_t>(stream.gcount()));
    text.erase(std::min(text.find_last_not_of(" \t\r\n") + 1, text.size()));
    const std::vector<std::string_view> numbers = SplitCsv(text);
    if (numbers.size() < kNumNumbers) return std::nullopt;
    std::string line;
    const auto add = [&](std::size_t begin, std::size_t count) {
      for (const std::string_view number : std::span(numbers).subspan(begin, count))
        line.append(",").append(number);
    };
    switch (stream_.kind) {
      case TableKind::kImu:
        add(kRate, 3);
        add(kAcceleration, 3);
        break;
      case TableKind::kWheels:
        add(kForwardSpeed, 1);
        add(kRate + 2, 1);
        break;
      case TableKind::kGnss: {
        const std::optional<double> accuracy = ParseDouble(numbers[kAccuracy]);
        if (!accuracy) return std::nullopt;
        add(kLatitude, 3);
        add(kAccuracy, 1);
        add(kAccuracy, 1);
        line.append(",").append(std::to_string(2 * *accuracy));
        break;
      }
      case TableKind::kImages: break;
    }
    return line;
  }

  void CountBad(const std::string& what) {
    if (bad_lines_.count++ == 0) bad_lines_.first = what;
  }

  std::ifstream stamps_;
  FolderStream stream_;
  std::uint64_t index_ = 0;
  std::string extension_;
  BadLines bad_lines_;
};

std::string StampOf(const std::string& name) { return name.substr(0, name.rfind('.')); }

/// Images that are called by their stamps, in the order of these.
class NamedImages : public FolderRows {
 public:
  NamedImages(const FolderStream& stream, std::uint64_t place)
      : folder_(stream.data), next_(place) {
    for (std::string& name : StampedImages(folder_))
      if (const auto stamp = ParseStamp(StampOf(name), stream.format.unit))
        images_.emplace_back(*stamp, std::move(name));
      else if (bad_lines_.count++ == 0)
        bad_lines_.first = "the name '" + name.substr(0, 40) + "'";
    std::sort(images_.begin(), images_.end());
  }

  std::optional<EurocLine> Next() override {
    if (next_ >= images_.size()) return std::nullopt;
    const auto& [stamp, name] = images_[next_];
    return EurocLine{stamp, (folder_ / name).string(), next_++};
  }
  const BadLines& bad_lines() const override { return bad_lines_; }

 private:
  fs::path folder_;
  std::vector<std::pair<Timestamp, std::string>> images_;
  std::uint64_t next_ = 0;
  BadLines bad_lines_;
};

}  // namespace

std::unique_ptr<FolderRows> OpenRows(const FolderStream& stream, std::uint64_t place) {
  if (stream.index == stream.data) return std::make_unique<NamedImages>(stream, place);
  if (stream.index.filename() == "timestamps.txt")
    return std::make_unique<KittiRows>(stream, place);
  return std::make_unique<TableRows>(stream, place);
}

}  // namespace parkade
