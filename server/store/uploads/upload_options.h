#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "server/store/receive_upload.h"

namespace parkade {

struct UploadOptions {
  /// Throws unless the file looks like a drive log; the name is the user's.
  std::function<void(const std::filesystem::path&, const std::string& filename)> check_log;
  /// Throws unless an archive of files with these paths would be a drive log.
  std::function<void(const std::vector<std::string>& paths)> check_paths;
  std::function<void(const ReceivedDrive&)> on_received;  ///< from any thread
  bool merge_drives = true;
  std::chrono::hours lifetime{24 * 7};  ///< of an upload that nothing is added to
};

}  // namespace parkade
