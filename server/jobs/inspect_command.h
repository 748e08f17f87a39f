#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// The command line that inspects a log, with the folder of its rig if any, and leaves what it
/// found in the file `out`: JSON with `state` and `missing` as `parkade inspect --json` has them.
/// When it fails with status 1 and no file, the last line that it prints is a sentence for the
/// user.
using InspectCommand = std::function<std::vector<std::string>(
    const std::filesystem::path& log, const std::optional<std::filesystem::path>& rig,
    const std::filesystem::path& out)>;

}  // namespace parkade
