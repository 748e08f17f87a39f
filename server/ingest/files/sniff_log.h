#pragma once

#include <filesystem>

namespace parkade {

/// Throws Error{kInvalidInput} unless the file begins like a format that
/// OpenDriveLog reads. Looks at the first block only: cheap enough for a file
/// that has just arrived; whether it holds a drive is for the job to find out.
void CheckLooksLikeLog(const std::filesystem::path& file);

}  // namespace parkade
