#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// What a client says beforehand of a file of its drive.
struct UploadPart {
  std::string path;  ///< as it is to be called in the drive's folder
  std::int64_t bytes = 0;
  std::optional<std::string> sha256;
};

/// True for 64 hexadecimal digits in lower case.
bool IsSha256(const std::string& text);

/// Throws Error{kInvalidInput} unless `parts`, in order of their paths, can be those of a set: 1 to
/// 10,000 files of plain relative paths, no two alike, none empty, of a size in all that is one.
void CheckParts(const std::vector<UploadPart>& parts);

}  // namespace parkade
