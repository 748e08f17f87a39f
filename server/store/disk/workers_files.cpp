#include "server/store/disk/workers_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/error.h"
#include "core/file_error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// An open file or folder, which is closed in the end.
class Handle {
 public:
  explicit Handle(int fd) : fd_(fd) {}
  ~Handle() {
    if (fd_ >= 0) ::close(fd_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  int get() const { return fd_; }
  int Release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

int OpenFolder(const fs::path& folder) {
  return ::open(folder.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

}  // namespace

int OpenWorkersFile(const fs::path& file) {
  const Handle folder(OpenFolder(file.parent_path()));
  if (folder.get() < 0) return -1;
  Handle opened(::openat(folder.get(), file.filename().c_str(),
                         O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  const bool is_plain =
      opened.get() >= 0 && ::fstat(opened.get(), &status) == 0 && S_ISREG(status.st_mode);
  return is_plain ? opened.Release() : -1;
}

std::string ReadWorkersFile(const fs::path& file, std::size_t max_bytes) {
  const std::string name = "'" + file.filename().string() + "'";
  const Handle opened(OpenWorkersFile(file));
  Require(opened.get() >= 0, ErrorCode::kNotFound, "there is no file " + name);
  std::string content;
  std::string piece(std::size_t{64} << 10, '\0');
  for (ssize_t count; (count = ::read(opened.get(), piece.data(), piece.size())) != 0;) {
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) ThrowErrno("cannot read " + name, errno);
    content.append(piece, 0, static_cast<std::size_t>(count));
    Require(content.size() <= max_bytes, ErrorCode::kInvalidInput, name + " is too large");
  }
  return content;
}

void TakeWorkersFolder(const fs::path& from, const fs::path& to) {
  const Handle parent(OpenFolder(from.parent_path()));
  struct stat status {};
  const bool is_folder =
      parent.get() >= 0 &&
      ::fstatat(parent.get(), from.filename().c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 &&
      S_ISDIR(status.st_mode);
  Require(is_folder, ErrorCode::kInternal,
          "the worker left no folder '" + from.filename().string() + "'");
  if (::renameat(parent.get(), from.filename().c_str(), AT_FDCWD, to.c_str()) != 0)
    ThrowErrno("cannot take '" + from.filename().string() + "'", errno);
  // Who could still change it can only have put something else in its place.
  Require(fs::is_directory(fs::symlink_status(to)), ErrorCode::kInternal,
          "the worker left no folder '" + from.filename().string() + "'");
}

}  // namespace parkade
