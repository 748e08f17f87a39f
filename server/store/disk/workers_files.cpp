#include "server/store/disk/workers_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "core/error.h"
#include "core/files/file_error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

FileHandle OpenFolder(const fs::path& folder) {
  return FileHandle(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
}

}  // namespace

FileHandle OpenWorkersFile(const fs::path& file) {
  const FileHandle folder = OpenFolder(file.parent_path());
  if (!folder.is_open()) return {};
  FileHandle opened(::openat(folder.fd(), file.filename().c_str(),
                             O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  const bool is_plain =
      opened.is_open() && ::fstat(opened.fd(), &status) == 0 && S_ISREG(status.st_mode);
  if (!is_plain) opened.Close();
  return opened;
}

std::string ReadWorkersFile(const fs::path& file, std::size_t max_bytes) {
  const std::string name = "'" + file.filename().string() + "'";
  const FileHandle opened = OpenWorkersFile(file);
  Require(opened.is_open(), ErrorCode::kNotFound, "there is no file " + name);
  std::string content;
  std::string piece(std::size_t{64} << 10, '\0');
  for (ssize_t count; (count = ::read(opened.fd(), piece.data(), piece.size())) != 0;) {
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) ThrowErrno("cannot read " + name, errno);
    content.append(piece, 0, static_cast<std::size_t>(count));
    Require(content.size() <= max_bytes, ErrorCode::kInvalidInput, name + " is too large");
  }
  return content;
}

void TakeWorkersFolder(const fs::path& from, const fs::path& to) {
  const FileHandle parent = OpenFolder(from.parent_path());
  struct stat status {};
  const bool is_folder =
      parent.is_open() &&
      ::fstatat(parent.fd(), from.filename().c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 &&
      S_ISDIR(status.st_mode);
  Require(is_folder, ErrorCode::kInternal,
          "the worker left no folder '" + from.filename().string() + "'");
  if (::renameat(parent.fd(), from.filename().c_str(), AT_FDCWD, to.c_str()) != 0)
    ThrowErrno("cannot take '" + from.filename().string() + "'", errno);
  // Who could still change it can only have put something else in its place.
  Require(fs::is_directory(fs::symlink_status(to)), ErrorCode::kInternal,
          "the worker left no folder '" + from.filename().string() + "'");
}

}  // namespace parkade
