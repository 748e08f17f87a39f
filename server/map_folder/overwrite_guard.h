#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace parkade {

/// Makes sure that a map that goes into `folder` replaces an older map there and nothing else.
/// Throws Error{kInvalidInput} where one of the folders that it needs (one per drive, `tiles`) is
/// there already and does not belong to a map. Creates nothing.
void RequireOverwritable(const std::filesystem::path& folder,
                         const std::vector<std::string>& drives);

/// Removes files that an older map in `folder` has and the new one in `staging` has not: they would
/// pass for the new map's.
void RemoveRestOfOldMap(const std::filesystem::path& folder, const std::filesystem::path& staging);

}  // namespace parkade
