#pragma once

#include <filesystem>

#include "server/ingest/files/temporary_folder.h"

namespace parkade {

/// A file of its own, to be written, that is removed with the object.
class TemporaryFile {
 public:
  /// Lies in a TemporaryFolder in `folder`, which throws.
  explicit TemporaryFile(const std::filesystem::path& folder)
      : folder_(folder), path_(folder_.path() / "content") {}

  const std::filesystem::path& path() const { return path_; }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_;
};

}  // namespace parkade
