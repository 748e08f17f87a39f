#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "server/build_map.h"

namespace parkade {

/// Writes report.json: versions, options, timings per stage, peak memory, health
/// per stream, initialisation, GNSS residuals, figures of the map, warnings.
/// Paths and names of machines stay out of it. Whole or not at all.
void WriteReport(const BuiltMap& built, const std::vector<std::unique_ptr<RecordedDrive>>& logs,
                 const MapOptions& options, const std::vector<StageTiming>& timings, const std::filesystem::path& file);

}  // namespace parkade
