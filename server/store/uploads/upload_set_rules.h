#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/uploads/upload_sets.h"

namespace parkade {

/// True for 64 hexadecimal digits in lower case.
bool IsSha256(const std::string& text);

/// Throws Error{kInvalidInput} unless `parts`, in order of their paths, can be those of a set: 1 to
/// 10,000 files of plain relative paths, no two alike, none empty, of a size in all that is one.
void CheckParts(const std::vector<UploadPart>& parts);

}  // namespace parkade
