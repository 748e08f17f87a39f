#pragma once

#include <filesystem>

namespace parkade {

/// A new folder, readable by its owner alone, that is deleted with everything in it at the end.
class TemporaryFolder {
 public:
  /// Makes it in `parent`, or in the system's temporary folder where that is empty. Throws
  /// Error{kInternal} when it cannot be made.
  explicit TemporaryFolder(const std::filesystem::path& parent);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace parkade
