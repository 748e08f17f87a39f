#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "server/ingest/files/euroc_csv.h"

namespace parkade {

/// One stream of a drive's folder.
struct FolderStream {
  std::string topic;  ///< "imu0", "cam0/semantic"
  TableKind kind = TableKind::kImu;
  /// What tells the stamps: a data.csv, a timestamps.txt, or a folder whose files are called by
  /// theirs.
  std::filesystem::path index;
  std::filesystem::path data;  ///< the folder of the files, if each row has one
  TableFormat format = {};
};

/// Whether a file is an image that is called by its stamp, "1317042651.168593664.png".
bool IsStampedImage(std::string_view name);

/// The names of such images in a folder, in no order.
std::vector<std::string> StampedImages(const std::filesystem::path& folder);

/// The unit of the stamps by which the images of a folder are called.
StampUnit UnitOfNames(const std::filesystem::path& images);

}  // namespace parkade
