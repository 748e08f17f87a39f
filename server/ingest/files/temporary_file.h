#pragma once

#include <filesystem>

namespace parkade {

/// An empty file of its own name that is removed with the object.
class TemporaryFile {
 public:
  /// Makes it in `folder`, or where that is empty in the system's folder for temporary files
  /// (TMPDIR). Throws Error{kInternal}, or Error{kDiskFull}.
  explicit TemporaryFile(const std::filesystem::path& folder);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace parkade
