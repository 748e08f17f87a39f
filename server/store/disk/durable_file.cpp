#include "server/store/disk/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/files/file_error.h"
#include "server/store/disk/disk_failure.h"

namespace parkade {

void ThrowNotKept(int error) {
  if (error == ENOSPC || error == EDQUOT) ThrowErrno("cannot write to the data directory", error);
  throw DiskFailure(std::string("the disk of the data directory failed: ") + std::strerror(error));
}

void KeepFile(const std::filesystem::path& file, const std::filesystem::path& target) {
  CreateDurableFolder(target.parent_path());
  // A link takes no place that is taken, and a rename does: so first the one and then the other.
  const std::filesystem::path link = target.string() + ".new";
  ::unlink(link.c_str());
  if (::link(file.c_str(), link.c_str()) != 0 || ::rename(link.c_str(), target.c_str()) != 0)
    ThrowErrno("cannot keep a file in the data directory", errno);
  ::unlink(link.c_str());  // renaming a link to its own file leaves it
  SyncToDisk(target.parent_path());
}

void SyncToDisk(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) ThrowErrno("cannot open a path of the data directory", errno);
  const int result = ::fsync(fd);
  const int error = errno;
  ::close(fd);
  if (result != 0) ThrowNotKept(error);
}

void MakeReadOnly(const std::filesystem::path& file) {
  if (::chmod(file.c_str(), 0444) != 0)
    ThrowErrno("cannot change a file of the data directory", errno);
  SyncToDisk(file);
}

void CreateDurableFolder(const std::filesystem::path& folder) {
  if (folder.empty() || std::filesystem::is_directory(folder)) return;
  CreateDurableFolder(folder.parent_path());
  if (::mkdir(folder.c_str(), 0755) != 0 && errno != EEXIST)
    ThrowErrno("cannot create the folder '" + folder.string() + "'", errno);
  SyncToDisk(folder.has_parent_path() ? folder.parent_path() : ".");
}

std::int64_t FreeBytes(const std::filesystem::path& path) {
  struct statvfs info {};
  if (::statvfs(path.c_str(), &info) != 0)
    ThrowErrno("cannot ask for the free space of the data directory", errno);
  return static_cast<std::int64_t>(info.f_bavail) * static_cast<std::int64_t>(info.f_frsize);
}

}  // namespace parkade
