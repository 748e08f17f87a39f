#include "server/store/disk/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "server/store/disk/disk_failure.h"

namespace parkade {
namespace {

constexpr size_t kWriteSize = size_t{1} << 20;
constexpr std::int64_t kEarlySyncBytes = std::int64_t{8} << 20;

bool IsFull(int error) { return error == ENOSPC || error == EDQUOT; }

[[noreturn]] void ThrowErrno(const std::string& what, int error) {
  if (IsFull(error)) throw Error(ErrorCode::kDiskFull, "the disk of the data directory is full");
  throw Error(ErrorCode::kInternal, what + ": " + std::strerror(error));
}

[[noreturn]] void ThrowNotKept(int error) {
  if (IsFull(error)) ThrowErrno("", error);
  throw DiskFailure(std::string("the disk of the data directory failed: ") + std::strerror(error));
}

}  // namespace

GrowingFile::GrowingFile(std::filesystem::path path, std::int64_t expected_bytes)
    : path_(std::move(path)) {
  // Reserving more than there is would take all of it from everybody else before it fails.
  if (expected_bytes > FreeBytes(path_.parent_path())) ThrowErrno("cannot reserve space", ENOSPC);
  fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd_ < 0) ThrowErrno("cannot create a file in the data directory", errno);
  pending_.reserve(kWriteSize);
  if (expected_bytes > 0 && ::fallocate(fd_, FALLOC_FL_KEEP_SIZE, 0, expected_bytes) != 0 &&
      errno == ENOSPC) {
    ::close(fd_);
    ::unlink(path_.c_str());
    ThrowErrno("cannot reserve space", ENOSPC);
  }
}

GrowingFile::~GrowingFile() {
  if (fd_ >= 0) ::close(fd_);
  if (!path_.empty()) ::unlink(path_.c_str());
}

void GrowingFile::Append(std::string_view bytes) {
  size_ += static_cast<std::int64_t>(bytes.size());
  while (!bytes.empty()) {
    const std::string_view piece = bytes.substr(0, kWriteSize - pending_.size());
    pending_.insert(pending_.end(), piece.begin(), piece.end());
    bytes.remove_prefix(piece.size());
    if (pending_.size() == kWriteSize) Flush();
  }
}

void GrowingFile::Flush() {
  std::string_view rest(pending_.data(), pending_.size());
  hash_.Add(rest);
  while (!rest.empty()) {
    const ssize_t written = ::write(fd_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<size_t>(written));
    } else if (errno != EINTR) {
      ThrowNotKept(errno);
    }
  }
  pending_.clear();
  // The disk starts early, so that the fsync at the end has little left to wait for.
  if (const std::int64_t behind = size_ - flushed_; behind >= kEarlySyncBytes) {
    ::sync_file_range(fd_, flushed_, behind, SYNC_FILE_RANGE_WRITE);
    flushed_ = size_;
  }
}

std::string GrowingFile::Finish() {
  Flush();
  if (::fchmod(fd_, 0444) != 0 || ::fsync(fd_) != 0) ThrowNotKept(errno);
  const int result = ::close(fd_);
  fd_ = -1;
  if (result != 0) ThrowNotKept(errno);
  return hash_.Finish();
}

void GrowingFile::MoveTo(const std::filesystem::path& target) {
  CreateDurableFolder(target.parent_path());
  if (::rename(path_.c_str(), target.c_str()) != 0)
    ThrowErrno("cannot rename in the data directory", errno);
  path_.clear();
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
