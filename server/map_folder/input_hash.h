#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace parkade {

/// Identifies an input that a map was made from: a file, a database with the write-ahead log beside
/// it, or a folder with all that is in it.
struct InputHash {
  std::string name;  ///< the last part of the path
  std::int64_t bytes = 0;
  std::string sha256;  ///< of several files: of lines "SHA256 BYTES NAME" of each, sorted by name
};

/// Reads everything once. Folders that cannot be opened count as empty.
/// \param left_out a folder inside of `path` that does not count, such as the one a map is written
/// to Throws Error{kInvalidInput} for a file that cannot be read.
InputHash HashInput(const std::filesystem::path& path, const std::filesystem::path& left_out = {});

}  // namespace parkade
