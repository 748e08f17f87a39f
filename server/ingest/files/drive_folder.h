#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/ingest/files/folder_stream.h"

namespace parkade {

/// How a drive lies in a folder of files.
enum class FolderLayout {
  kEuroc,  ///< imu0/data.csv, cam0/data.csv, cam0/data/, ...
  kKitti,  ///< oxts/, image_00/, ...: each with timestamps.txt and data/
  kPlain,  ///< imu.csv, cam0/<stamp>.png, ...
};

struct DriveFolder {
  std::filesystem::path path;
  FolderLayout layout = FolderLayout::kEuroc;
};

/// The drive in `folder`: itself, or the only one at most three levels down. Nothing when there is
/// none; throws Error{kInvalidInput} when there are several. `name` is what that calls the folder.
std::optional<DriveFolder> FindDriveFolder(const std::filesystem::path& folder,
                                           const std::string& name);

/// The streams of a drive: imu0, odom0, gnss0, then cameras by their numbers (KITTI's image_02 is
/// cam2), each with its masks.
std::vector<FolderStream> StreamsOf(const DriveFolder& folder);

/// The number of a camera's folder, "cam12" with the prefix "cam"; nothing for other names.
std::optional<int> CameraNumber(std::string_view name, std::string_view prefix);

}  // namespace parkade
