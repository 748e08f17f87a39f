#include "server/store/disk/growing_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/files/file_error.h"
#include "server/store/disk/durable_file.h"

namespace parkade {
namespace {

constexpr size_t kWriteSize = size_t{1} << 20;
constexpr std::int64_t kEarlySyncBytes = std::int64_t{8} << 20;

}  // namespace

GrowingFile::GrowingFile(int fd, std::int64_t size) : fd_(fd), size_(size), flushed_(size) {
  pending_.reserve(kWriteSize);
}

GrowingFile::GrowingFile(GrowingFile&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      size_(other.size_),
      flushed_(other.flushed_),
      pending_(std::move(other.pending_)) {}

GrowingFile::~GrowingFile() {
  if (fd_ >= 0) ::close(fd_);
}

GrowingFile GrowingFile::Create(const std::filesystem::path& path, std::int64_t expected_bytes) {
  // Reserving more than there is would take all of it from everybody else before it fails.
  if (expected_bytes > FreeBytes(path.parent_path())) ThrowErrno("cannot reserve space", ENOSPC);
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) ThrowErrno("cannot create a file in the data directory", errno);
  if (expected_bytes > 0 && ::fallocate(fd, FALLOC_FL_KEEP_SIZE, 0, expected_bytes) != 0 &&
      errno == ENOSPC) {
    ::close(fd);
    ::unlink(path.c_str());
    ThrowErrno("cannot reserve space", ENOSPC);
  }
  return {fd, 0};
}

GrowingFile GrowingFile::Open(const std::filesystem::path& path, std::int64_t bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) ThrowErrno("cannot open a file of the data directory", errno);
  return {fd, bytes};
}

GrowingFile GrowingFile::Continue(const std::filesystem::path& path, std::int64_t bytes) {
  GrowingFile file = Open(path, bytes);
  file.Truncate(bytes);
  return file;
}

GrowingFile GrowingFile::WriteOver(const std::filesystem::path& path, std::int64_t first) {
  GrowingFile file = Open(path, first);
  struct stat info {};
  const bool is_there = ::fstat(file.fd_, &info) == 0 && info.st_size >= first &&
                        ::lseek(file.fd_, first, SEEK_SET) == first;
  if (!is_there) ThrowErrno("a file of the data directory is shorter than it was", EIO);
  return file;
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
  while (!rest.empty()) {
    const ssize_t written = ::write(fd_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<size_t>(written));
    } else if (errno != EINTR) {
      ThrowNotKept(errno);
    }
  }
  pending_.clear();
  // The disk starts early, so that the sync at the end has little left to wait for.
  if (const std::int64_t behind = size_ - flushed_; behind >= kEarlySyncBytes) {
    ::sync_file_range(fd_, flushed_, behind, SYNC_FILE_RANGE_WRITE);
    flushed_ = size_;
  }
}

void GrowingFile::Skip(std::int64_t bytes) {
  Flush();
  size_ += bytes;
  flushed_ = size_;
  struct stat info {};
  const bool is_there = ::fstat(fd_, &info) == 0 &&
                        (info.st_size >= size_ || ::ftruncate(fd_, size_) == 0) &&
                        ::lseek(fd_, size_, SEEK_SET) == size_;
  if (!is_there) ThrowNotKept(errno);
}

void GrowingFile::Truncate(std::int64_t bytes) {
  pending_.clear();
  // Room that is reserved beyond the end is kept: only what was written is cut off.
  struct stat info {};
  const bool is_cut = ::fstat(fd_, &info) == 0 && info.st_size >= bytes &&
                      (info.st_size == bytes || ::ftruncate(fd_, bytes) == 0) &&
                      ::lseek(fd_, bytes, SEEK_SET) == bytes;
  if (!is_cut) ThrowErrno("a file of the data directory is shorter than it was", EIO);
  size_ = flushed_ = bytes;
}

void GrowingFile::Sync() {
  Flush();
  if (::fdatasync(fd_) != 0) ThrowNotKept(errno);
}

void GrowingFile::Finish() {
  Flush();
  if (::fchmod(fd_, 0444) != 0 || ::fsync(fd_) != 0) ThrowNotKept(errno);
  const int result = ::close(std::exchange(fd_, -1));
  if (result != 0) ThrowNotKept(errno);
}

}  // namespace parkade
