#include "server/ingest/files/drive_folder.h"

#include <algorithm>
#include <functional>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char *kCamera = "cam", *kKittiCamera = "image_", *kKittiStamps = "timestamps.txt";

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

bool HasStampedImage(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (IsStampedImage(entry->path().filename().string())) return true;
  return false;
}

bool IsEuroc(const fs::path& folder) {
  return IsFile(folder / "imu0" / "data.csv") || IsFile(folder / "cam0" / "data.csv");
}

bool IsKitti(const fs::path& folder) {
  return IsFile(folder / "oxts" / kKittiStamps) || IsFile(folder / "image_00" / kKittiStamps) ||
         IsFile(folder / "image_02" / kKittiStamps);
}

/// A recording whose images somebody unpacked beside it is still the recording.
bool HasLogFile(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    if (extension == ".bag" || extension == ".mcap" || extension == ".db3" || extension == ".zstd")
      return true;
  }
  return false;
}

bool IsPlain(const fs::path& folder) {
  const std::vector<fs::path> below = SortedFolders(folder);
  return std::any_of(below.begin(), below.end(), [](const fs::path& child) {
    return CameraNumber(child.filename().string(), kCamera) && HasStampedImage(child);
  });
}

using IsDrive = std::function<std::optional<FolderLayout>(const fs::path&)>;

std::optional<DriveFolder> Find(const fs::path& folder, const std::string& name,
                                const IsDrive& is_drive) {
  constexpr int kMaxDepth = 3;
  std::vector<fs::path> level{folder};
  for (int depth = 0; depth <= kMaxDepth; ++depth) {
    std::vector<DriveFolder> found;
    std::vector<fs::path> below;
    for (const fs::path& candidate : level) {
      if (const auto layout = is_drive(candidate)) found.push_back({candidate, *layout});
      if (depth == kMaxDepth) continue;
      for (const fs::path& child : SortedFolders(candidate)) below.push_back(child);
    }
    const bool are_euroc = std::all_of(found.begin(), found.end(), [](const DriveFolder& drive) {
      return drive.layout == FolderLayout::kEuroc;
    });
    Require(found.size() <= 1, ErrorCode::kInvalidInput,
            name + " holds several " + (are_euroc ? "EuRoC " : "") + "drives: give one of them");
    if (!found.empty()) return found.front();
    level = std::move(below);
  }
  return std::nullopt;
}

std::vector<FolderStream> EurocStreams(const fs::path& folder) {
  std::vector<FolderStream> streams;
  const auto add = [&](const std::string& topic, TableKind kind) {
    const fs::path table = folder / topic / "data.csv";
    if (!IsFile(table)) return;
    FolderStream stream{topic, kind, table, {}, FormatOf(table, kind)};
    if (kind == TableKind::kImages) {
      const fs::path data = folder / topic / "data";
      stream.data = fs::is_directory(data) ? data : folder / topic;
    }
    streams.push_back(std::move(stream));
  };
  add("imu0", TableKind::kImu);
  add("odom0", TableKind::kWheels);
  add("gnss0", TableKind::kGnss);
  for (const fs::path& child : SortedFolders(folder)) {
    const std::string name = child.filename().string();
    if (!CameraNumber(name, kCamera)) continue;
    add(name, TableKind::kImages);
    add(name + "/semantic", TableKind::kImages);
  }
  return streams;
}

std::vector<FolderStream> KittiStreams(const fs::path& folder) {
  std::vector<FolderStream> streams;
  const fs::path oxts = folder / "oxts";
  if (IsFile(oxts / kKittiStamps)) {
    streams.push_back({"imu0", TableKind::kImu, oxts / kKittiStamps, oxts / "data"});
    streams.push_back({"odom0", TableKind::kWheels, oxts / kKittiStamps, oxts / "data"});
    streams.push_back({"gnss0", TableKind::kGnss, oxts / kKittiStamps, oxts / "data"});
  }
  for (const fs::path& child : SortedFolders(folder))
    if (const auto number = CameraNumber(child.filename().string(), kKittiCamera);
        number && IsFile(child / kKittiStamps))
      streams.push_back({kCamera + std::to_string(*number), TableKind::kImages,
                         child / kKittiStamps, child / "data"});
  return streams;
}

std::vector<FolderStream> PlainStreams(const fs::path& folder) {
  std::vector<FolderStream> streams;
  const auto add_table = [&](const char* topic, const char* file, TableKind kind) {
    if (IsFile(folder / file))
      streams.push_back({topic, kind, folder / file, {}, FormatOf(folder / file, kind)});
  };
  add_table("imu0", "imu.csv", TableKind::kImu);
  add_table("odom0", "wheels.csv", TableKind::kWheels);
  add_table("gnss0", "gnss.csv", TableKind::kGnss);
  const auto add_images = [&](const std::string& topic, const fs::path& images) {
    if (HasStampedImage(images))
      streams.push_back({topic, TableKind::kImages, images, images, {UnitOfNames(images), {}}});
  };
  for (const fs::path& child : SortedFolders(folder)) {
    const auto number = CameraNumber(child.filename().string(), kCamera);
    if (!number) continue;
    add_images(kCamera + std::to_string(*number), child);
    add_images(kCamera + std::to_string(*number) + "/semantic", child / "semantic");
  }
  return streams;
}

}  // namespace

std::optional<int> CameraNumber(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  if (name.empty() || name.size() > 3) return std::nullopt;
  int number = 0;
  for (const char c : name) {
    if (c < '0' || c > '9') return std::nullopt;
    number = 10 * number + (c - '0');
  }
  return number;
}

std::optional<DriveFolder> FindDriveFolder(const fs::path& folder, const std::string& name) {
  const bool is_recording = HasLogFile(folder);
  const auto tables = [&](const fs::path& candidate) -> std::optional<FolderLayout> {
    if (IsEuroc(candidate)) return FolderLayout::kEuroc;
    if (IsKitti(candidate)) return FolderLayout::kKitti;
    if (!is_recording && IsFile(candidate / "imu.csv") && IsPlain(candidate))
      return FolderLayout::kPlain;
    return std::nullopt;
  };
  std::optional<DriveFolder> found = Find(folder, name, tables);
  if (found || is_recording) return found;
  // What has images alone is still a drive, of which can be said what is missing.
  return Find(folder, name, [](const fs::path& candidate) {
    return IsPlain(candidate) ? std::optional(FolderLayout::kPlain) : std::nullopt;
  });
}

std::vector<FolderStream> StreamsOf(const DriveFolder& folder) {
  switch (folder.layout) {
    case FolderLayout::kEuroc: return EurocStreams(folder.path);
    case FolderLayout::kKitti: return KittiStreams(folder.path);
    case FolderLayout::kPlain: break;
  }
  return PlainStreams(folder.path);
}

}  // namespace parkade
