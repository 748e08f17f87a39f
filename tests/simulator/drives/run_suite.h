#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "tests/simulator/drives/presets.h"

namespace parkade::simulator {

/// The presets of these names, in their quick form or whole; all where no names are given. Throws
/// Error{kUsage} for an unknown name.
std::vector<Preset> ChoosePresets(const std::vector<std::string>& names, bool is_quick);

/// Makes FOLDER/NAME/drive.mcap and FOLDER/NAME/truth/ of each preset. A drive that is there with
/// the same options (by their hash) stays; one that was interrupted is made anew. Prints a line per
/// drive and the time of all.
void RunSuite(const std::vector<Preset>& presets, const std::filesystem::path& folder,
              std::ostream& out);

}  // namespace parkade::simulator
