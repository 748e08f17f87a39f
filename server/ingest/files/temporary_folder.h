#pragma once

#include <filesystem>

namespace parkade {

/// A new folder, readable by its owner alone, that is deleted with everything in it at the end. One
/// whose process was killed is deleted when the next is made beside it: a process holds a lock on
/// each of its own.
class TemporaryFolder {
 public:
  /// Makes it in `parent`, or in the system's temporary folder (TMPDIR) where that is empty. Throws
  /// Error{kInternal} when it cannot be made, Error{kDiskFull}.
  explicit TemporaryFolder(const std::filesystem::path& parent);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Deletes all of this process, for one that is about to be ended. Thread-safe.
  static void RemoveAll();

 private:
  std::filesystem::path path_;
  int lock_fd_ = -1;
};

}  // namespace parkade
