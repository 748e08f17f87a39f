#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/sha256.h"

namespace parkade {

/// A file that grows under a temporary name and is gone unless it was kept.
/// Bounded memory: pieces are collected to writes of 1 MiB and hashed on the
/// way. One thread at a time.
class GrowingFile {
 public:
  /// Creates `path`, which must not exist, and reserves `expected_bytes` on the
  /// disk where the filesystem can. Throws Error{kDiskFull}, Error{kInternal}.
  GrowingFile(std::filesystem::path path, std::int64_t expected_bytes);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  void Append(std::string_view bytes);

  /// Writes what is left, makes the file durable and read-only, and returns the
  /// SHA-256 of its content. It is still removed unless moved away. Throws DiskFailure,
  /// Error{kDiskFull}.
  std::string Finish();

  std::int64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

  /// Renames the finished file over `target`, creating the target's folder.
  /// Durable when it returns.
  void MoveTo(const std::filesystem::path& target);

 private:
  void Flush();

  std::filesystem::path path_;
  int fd_ = -1;
  std::int64_t size_ = 0, flushed_ = 0;
  std::vector<char> pending_;
  Sha256 hash_;
};

/// fsync of a file or folder. Throws DiskFailure, or Error where it cannot be opened.
void SyncToDisk(const std::filesystem::path& path);

/// Creates `folder` and its missing parents and makes their entries durable.
void CreateDurableFolder(const std::filesystem::path& folder);

/// Bytes an unprivileged writer may still use on the filesystem of `path`.
std::int64_t FreeBytes(const std::filesystem::path& path);

}  // namespace parkade
