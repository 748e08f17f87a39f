#include "server/ingest/files/archive_paths.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "server/ingest/files/drive_folder.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPathLength = 1024, kMaxNameLength = 128, kMaxDepth = 3;
constexpr std::string_view kMetadata = "metadata.yaml";
/// Rows of a database may lie in the -wal file beside it.
constexpr std::array<std::string_view, 4> kLogExtensions = {".bag", ".mcap", ".db3", ".db3-wal"};

std::vector<std::string> SplitPath(std::string_view path) {
  std::vector<std::string> parts;
  while (!path.empty()) {
    const std::size_t slash = path.find('/');
    const std::string_view part = path.substr(0, slash);
    if (!part.empty() && part != ".") parts.emplace_back(part);
    path = slash == std::string_view::npos ? std::string_view{} : path.substr(slash + 1);
  }
  return parts;
}

bool IsPlainName(const std::string& name) {
  if (name.empty() || name.size() > kMaxNameLength || name.front() == '.') return false;
  return std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c < 128 && (std::isalnum(c) || c == '.' || c == '_' || c == '-');
  });
}

/// Hidden files are none: some programs put one beside each file.
bool IsLogFileName(std::string_view name) {
  constexpr std::string_view kPacked = ".zstd";
  if (name.starts_with('.')) return false;
  if (name.ends_with(kPacked)) name.remove_suffix(kPacked.size());
  return std::any_of(kLogExtensions.begin(), kLogExtensions.end(),
                     [&](std::string_view extension) { return name.ends_with(extension); });
}

/// A path inside a drive.
struct PathInDrive {
  std::string root;  ///< the folders above, "" or "drive/mav0/"
  fs::path relative;
};

/// Splits a path; nothing for files that are no part of an EuRoC drive.
std::optional<PathInDrive> ParseEurocPath(const std::vector<std::string>& parts) {
  std::string root;
  for (std::size_t i = 0; i + 1 < parts.size() && i <= kMaxDepth; root += parts[i] + "/", ++i) {
    const std::string& sensor = parts[i];
    const bool is_camera = CameraNumber(sensor, "cam").has_value();
    if (!is_camera && sensor != "imu0" && sensor != "odom0" && sensor != "gnss0") continue;
    std::vector<std::string> rest(parts.begin() + static_cast<std::ptrdiff_t>(i) + 1, parts.end());
    fs::path relative = sensor;
    if (is_camera && rest.front() == "semantic" && rest.size() > 1) {
      relative /= "semantic";
      rest.erase(rest.begin());
    }
    if (rest.size() == 1 && (rest[0] == "data.csv" || rest[0] == "sensor.yaml"))
      return PathInDrive{root, relative / rest[0]};
    if (is_camera && rest.size() == 2 && rest[0] == "data" && IsPlainName(rest[1]))
      return PathInDrive{root, relative / "data" / rest[1]};
  }
  return std::nullopt;
}

/// The same for drives of other layouts: KITTI's, or images and tables.
std::optional<PathInDrive> ParseOtherPath(const std::vector<std::string>& parts) {
  const std::string& name = parts.back();
  const auto in_folder = [&](std::size_t depth) {
    PathInDrive found;
    for (std::size_t i = 0; i + depth < parts.size(); ++i) found.root += parts[i] + "/";
    for (std::size_t i = parts.size() - depth; i < parts.size(); ++i) found.relative /= parts[i];
    return found;
  };
  const auto folder = [&](std::size_t levels) {  // above the file
    return levels < parts.size() ? std::string_view(parts[parts.size() - 1 - levels]) : "";
  };
  const auto is_kitti = [](std::string_view sensor) {
    return sensor == "oxts" || CameraNumber(sensor, "image_");
  };
  if (!IsPlainName(name) || parts.size() > kMaxDepth + 3) return std::nullopt;
  if (name == "imu.csv" || name == "wheels.csv" || name == "gnss.csv") return in_folder(1);
  if (name == "timestamps.txt" && is_kitti(folder(1))) return in_folder(2);
  if (folder(1) == "data" && is_kitti(folder(2))) return in_folder(3);
  if (!IsStampedImage(name)) return std::nullopt;
  if (CameraNumber(folder(1), "cam")) return in_folder(2);
  return folder(1) == "semantic" && CameraNumber(folder(2), "cam") ? std::optional(in_folder(3))
                                                                   : std::nullopt;
}

bool IsKittiCalibration(std::string_view name) {
  return name == "calib_cam_to_cam.txt" || name == "calib_velo_to_cam.txt" ||
         name == "calib_imu_to_velo.txt";
}

}  // namespace

void ArchivePaths::RequireInside(std::string_view path) const {
  const std::vector<std::string> parts = SplitPath(path);
  const bool leads_outside =
      path.starts_with('/') || std::find(parts.begin(), parts.end(), "..") != parts.end();
  Require(!leads_outside, ErrorCode::kInvalidInput,
          name_ + " holds an entry that leads outside of it");
}

std::optional<fs::path> ArchivePaths::PlaceOf(std::string_view path) {
  if (path.size() > kMaxPathLength) return std::nullopt;
  RequireInside(path);
  const std::vector<std::string> parts = SplitPath(path);
  if (parts.empty()) return std::nullopt;
  const std::optional<PathInDrive> euroc = ParseEurocPath(parts);
  if (!euroc) {
    const std::optional<fs::path> log_file = PlaceOfLogFile(parts);
    return log_file ? log_file : PlaceOfOtherFile(parts);
  }
  Note(Kind::kEuroc, euroc->root);
  return euroc->relative;
}

std::optional<fs::path> ArchivePaths::PlaceOfOtherFile(const std::vector<std::string>& parts) {
  constexpr std::size_t kMaxRoots = 100;
  if (kind_) return std::nullopt;
  // Where a drive looks for it: above its own folder.
  if (IsKittiCalibration(parts.back())) return parts.back();
  const std::optional<PathInDrive> found = ParseOtherPath(parts);
  if (!found) return std::nullopt;
  auto root = std::find(other_roots_.begin(), other_roots_.end(), found->root);
  if (root == other_roots_.end()) {
    if (other_roots_.size() == kMaxRoots) return std::nullopt;
    root = other_roots_.insert(root, found->root);
  }
  // A table alone is no drive, and other things are called so, too.
  has_other_drive_ = has_other_drive_ || found->relative.has_parent_path();
  return fs::path("drive" + std::to_string(root - other_roots_.begin())) / found->relative;
}

std::optional<fs::path> ArchivePaths::PlaceOfLogFile(const std::vector<std::string>& parts) {
  const std::string& file = parts.back();
  std::string root;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) root += parts[i] + "/";
  if (file == kMetadata) {
    // Alone it is no drive, and other things are called so, too.
    if (kind_ == Kind::kEuroc || (kind_ && root != root_)) return std::nullopt;
    metadata_root_ = root;
    return fs::path(name_) / file;
  }
  if (!IsLogFileName(file)) return std::nullopt;
  Require(IsPlainName(file), ErrorCode::kInvalidInput,
          name_ + " holds '" + file +
              "': the name of a log file is at most 128 letters, digits, dots, dashes and "
              "underscores");
  Note(Kind::kLogFiles, root);
  return fs::path(name_) / file;
}

void ArchivePaths::Note(Kind kind, const std::string& root) {
  if (!kind_) {
    kind_ = kind;
    root_ = root;
  }
  Require(kind == *kind_, ErrorCode::kInvalidInput,
          name_ + " holds both an EuRoC drive and log files: give one of them");
  Require(root == root_, ErrorCode::kInvalidInput,
          name_ + (kind == Kind::kEuroc ? " holds several EuRoC drives: give one of them"
                                        : " holds log files in several folders: give one of them"));
}

std::string ArchivePaths::SentenceWithoutDrive() const {
  return name_ +
         " holds no drive: neither EuRoC (mav0 with imu0, cam0, ...), KITTI raw (oxts, image_00, "
         "...) or images and tables (cam0, imu.csv, ...), nor log files (.bag, .mcap, .db3)";
}

void CheckHoldsDrive(const std::vector<std::string>& paths, const std::string& name) {
  ArchivePaths content(name);
  for (const std::string& path : paths) content.PlaceOf(path);
  Require(content.has_drive(), ErrorCode::kInvalidInput, content.SentenceWithoutDrive());
}

}  // namespace parkade
