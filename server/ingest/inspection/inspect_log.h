#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "server/ingest/drive/first_look.h"
#include "server/ingest/inspection/log_inspection.h"

namespace parkade {

/// Reads a whole log and decodes every message and image, on all cores; of one that is unusable,
/// and of `large_log` bytes at least, only the beginning. Throws Error when it is no log at all.
LogInspection InspectLog(const std::filesystem::path& log,
                         const std::filesystem::path& rig_folder = {},
                         const std::filesystem::path& scratch_folder = {},
                         std::uint64_t large_log = kLargeLog);

std::string InspectionToText(const LogInspection& inspection);
nlohmann::json InspectionToJson(const LogInspection& inspection);

}  // namespace parkade
