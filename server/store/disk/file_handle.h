#pragma once

#include <unistd.h>

#include <utility>

namespace parkade {

/// A file descriptor, or -1 for none, that is closed in the end.
class FileHandle {
 public:
  FileHandle() = default;
  explicit FileHandle(int fd) : fd_(fd) {}
  ~FileHandle() { Close(); }
  FileHandle(FileHandle&& other) noexcept : fd_(other.Release()) {}
  FileHandle(const FileHandle&) = delete;
  FileHandle& operator=(const FileHandle&) = delete;

  bool is_open() const { return fd_ >= 0; }
  int fd() const { return fd_; }
  /// From now on the caller closes it.
  int Release() { return std::exchange(fd_, -1); }
  void Close() {
    if (is_open()) ::close(Release());
  }

 private:
  int fd_ = -1;
};

}  // namespace parkade
