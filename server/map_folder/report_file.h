#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace parkade {

/// report.json of a map, all but `join.pairs`: the links of a large site are most of the file, and
/// hardly a reader wants them. Throws nlohmann::json::exception where it is no JSON, Error where it
/// cannot be read.
nlohmann::json ReadReport(const std::filesystem::path& map);

}  // namespace parkade
