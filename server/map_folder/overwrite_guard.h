#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace parkade {

/// A map that goes into `folder` replaces the older one there, and nothing else: throws
/// Error{kInvalidInput} where one of its own folders, of `drives` or `tiles`, is there already and
/// of no map. Nothing that is missing is made.
void RequireOverwritable(const std::filesystem::path& folder,
                         const std::vector<std::string>& drives);

/// Takes away what an older map in `folder` has and the new one in `staging` has not: it would pass
/// for the new one's.
void RemoveRestOfOldMap(const std::filesystem::path& folder, const std::filesystem::path& staging);

}  // namespace parkade
