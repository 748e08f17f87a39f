#include "server/ingest/files/temporary_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <string>

#include "core/error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

const std::string kPrefix = "parkade-unpacked-";

std::mutex folders_mutex;
std::set<fs::path>& Folders() {
  static auto* folders = new std::set<fs::path>;  // outlives whatever is destroyed at exit
  return *folders;
}

/// Opens a folder of ours and locks it; -1 where that fails, with errno.
int Lock(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd < 0) return -1;
  struct stat status {};
  // Once it is locked nobody removes it, but it may just have been.
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0 && ::fstat(fd, &status) == 0 &&
      status.st_uid == ::geteuid() && status.st_nlink > 0)
    return fd;
  ::close(fd);
  return -1;
}

/// Removes folders that processes left behind which were killed: nobody locks them.
void RemoveOrphans(const fs::path& parent) {
  std::error_code error;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end;
       entry.increment(error)) {
    if (!entry->path().filename().native().starts_with(kPrefix)) continue;
    const int fd = Lock(entry->path());
    if (fd < 0) continue;
    std::error_code ignored;
    fs::remove_all(entry->path(), ignored);
    ::close(fd);
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder(const fs::path& parent) {
  std::error_code error;
  const fs::path folder = parent.empty() ? fs::temp_directory_path(error) : parent;
  Require(!error, ErrorCode::kInternal, "there is no folder for temporary files");
  RemoveOrphans(folder);
  constexpr int kTries = 10;  // another process may take a new one for an orphan
  for (int i = 0; i < kTries && lock_fd_ < 0; ++i) {
    std::string name = (folder / (kPrefix + "XXXXXX")).string();
    const bool is_made = ::mkdtemp(name.data()) != nullptr;
    const bool is_full = errno == ENOSPC || errno == EDQUOT;
    Require(is_made, is_full ? ErrorCode::kDiskFull : ErrorCode::kInternal,
            "cannot make a temporary folder in " + folder.string() + ": " + std::strerror(errno));
    lock_fd_ = Lock(name);
    path_ = name;
  }
  const std::lock_guard lock(folders_mutex);
  Folders().insert(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;  // nothing to be done about it here
  fs::remove_all(path_, ignored);
  if (lock_fd_ >= 0) ::close(lock_fd_);
  const std::lock_guard lock(folders_mutex);
  Folders().erase(path_);
}

void TemporaryFolder::RemoveAll() {
  const std::lock_guard lock(folders_mutex);
  for (const fs::path& folder : Folders()) {
    // Other threads may go on filling it.
    constexpr int kTries = 1000;
    std::error_code error;
    for (int i = 0; i < kTries && fs::exists(folder, error); ++i) fs::remove_all(folder, error);
  }
}

}  // namespace parkade
