#pragma once

#include <filesystem>

namespace parkade {

/// Makes files in `folder` that an older folder holds under the same names, with the same content,
/// one with those: a worker behind walls can only copy what it takes over. Files that cannot be
/// shared stay as they are. What is shared is as durable as it was.
void ShareFilesWith(const std::filesystem::path& older, const std::filesystem::path& folder);

}  // namespace parkade
