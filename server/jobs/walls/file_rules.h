#pragma once

#include <filesystem>
#include <vector>

namespace parkade {

/// What a worker may do with files. Paths are absolute.
struct FileRules {
  std::vector<std::filesystem::path> writable = {};  ///< folders that it may write in
  std::filesystem::path hidden = {};                ///< a folder that it is not to see; empty: none
  std::vector<std::filesystem::path> visible = {};  ///< what it may read of that all the same
};

}  // namespace parkade
