#include "server/map_folder/output_folder.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/error.h"

namespace parkade {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStaging = ".staging.";  // followed by the process's number

/// Removes folders that processes left behind which were ended in the middle.
void RemoveOrphans(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with(kStaging)) continue;
    const int process = std::atoi(name.c_str() + std::strlen(kStaging));
    if (process > 0 && ::kill(process, 0) != 0 && errno == ESRCH)
      fs::remove_all(entry.path(), ignored);
  }
}

}  // namespace

void RequireWritable(const fs::path& folder) {
  Require(fs::is_directory(folder), ErrorCode::kInvalidInput,
          "there is no folder '" + folder.string() + "'");
  Require(::access(folder.c_str(), W_OK) == 0, ErrorCode::kInvalidInput,
          "cannot write into '" + folder.string() + "': " + std::strerror(errno));
}

OutputFolder::OutputFolder(const fs::path& folder) : folder_(folder) {
  std::error_code error;
  is_made_here_ = !fs::exists(folder_, error);
  fs::create_directories(folder_, error);
  Require(
      fs::is_directory(folder_), ErrorCode::kInvalidInput,
      "cannot make the folder '" + folder_.string() + "'" + (error ? ": " + error.message() : ""));
  RemoveOrphans(folder_);
  staging_ = folder_ / (kStaging + std::to_string(::getpid()));
  fs::remove_all(staging_, error);
  fs::create_directory(staging_, error);
  const bool is_full = error == std::errc::no_space_on_device;
  Require(!error, is_full ? ErrorCode::kDiskFull : ErrorCode::kInvalidInput,
          "cannot write into '" + folder_.string() + "': " + error.message());
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  if (is_made_here_) fs::remove(folder_, ignored);  // only succeeds while empty
}

void OutputFolder::Commit() {
  std::vector<fs::directory_entry> made;
  for (const fs::directory_entry& entry : fs::directory_iterator(staging_)) made.push_back(entry);
  for (const fs::directory_entry& entry : made) {
    const fs::path name = entry.path().filename(), target = folder_ / name;
    // A folder cannot be renamed onto one that has files; the old files go with the rest of
    // staging.
    if (entry.is_directory() && fs::exists(target))
      fs::rename(target, staging_ / ("old " + name.string()));
    fs::rename(entry.path(), target);
  }
}

}  // namespace parkade
