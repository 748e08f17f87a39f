#pragma once

#include <filesystem>

namespace parkade {

/// The folder that a map goes to. Products are written into a hidden staging
/// folder inside it and moved out together, so that a run that fails leaves the
/// folder as it was (and removes it where it made it).
class OutputFolder {
 public:
  /// Throws Error{kInvalidInput} when `folder` is a file or cannot be written, Error{kDiskFull}.
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& staging() const { return staging_; }

  /// Moves everything from staging into the folder, replacing what has the same name.
  void Commit();

 private:
  std::filesystem::path folder_, staging_;
  bool is_made_here_ = false;
};

/// Throws Error{kInvalidInput} where `folder` is not a folder, or no file can be made in it.
void RequireWritable(const std::filesystem::path& folder);

}  // namespace parkade
