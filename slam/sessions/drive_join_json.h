#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/sessions/join_drives.h"

namespace parkade {

/// How drives were joined, for report.json.
/// \param names  of the drives
nlohmann::json ToJson(const DriveJoin& join, const std::vector<std::string>& names);

}  // namespace parkade
