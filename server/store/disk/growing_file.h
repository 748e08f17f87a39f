#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace parkade {

/// A file that grows at its end. Bounded memory: pieces are collected to writes of 1 MiB. One
/// thread at a time. Throws Error{kDiskFull}, DiskFailure.
class GrowingFile {
 public:
  /// Creates `path`, which must not exist, and reserves `expected_bytes` on the disk where the
  /// filesystem can. Nothing is left there when that fails.
  static GrowingFile Create(const std::filesystem::path& path, std::int64_t expected_bytes);
  /// Goes on after the first `bytes` of a file; what follows them is cut off.
  static GrowingFile Continue(const std::filesystem::path& path, std::int64_t bytes);
  /// Writes over what a file holds from the byte `first` on; nothing is cut off. Others may write
  /// to other parts of it meanwhile.
  static GrowingFile WriteOver(const std::filesystem::path& path, std::int64_t first);
  ~GrowingFile();
  GrowingFile(GrowingFile&& other) noexcept;
  GrowingFile& operator=(GrowingFile&&) = delete;

  void Append(std::string_view bytes);
  /// Goes `bytes` further; a file that ends before gets zeros there.
  void Skip(std::int64_t bytes);
  /// Takes back what was appended beyond `bytes`.
  void Truncate(std::int64_t bytes);
  /// Makes durable what was appended.
  void Sync();
  /// Does so, makes the file read-only and closes it.
  void Finish();

  /// [byte] where the next piece goes: the file's size, unless it is written over.
  std::int64_t size() const { return size_; }

 private:
  GrowingFile(int fd, std::int64_t size);
  static GrowingFile Open(const std::filesystem::path& path, std::int64_t bytes);
  void Flush();

  int fd_;
  std::int64_t size_, flushed_;
  std::vector<char> pending_;
};

}  // namespace parkade
