#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/map_folder/input_hash.h"
#include "server/pipeline/build_map.h"

namespace parkade {

/// The inputs that a drive of a map was made from.
struct DriveInputs {
  InputHash log;
  std::optional<InputHash> rig;  ///< nothing: the rig came with the log
};

/// Writes report.json: versions, options, timings per stage, peak memory, health
/// per stream, initialization, GNSS residuals, figures of the map, warnings.
/// `inputs` by the drives' names. Paths and names of machines stay out of it. Whole or not at all.
void WriteReport(const BuiltMap& built, const std::vector<std::unique_ptr<RecordedDrive>>& logs,
                 const MapOptions& options, const std::map<std::string, DriveInputs>& inputs,
                 const std::vector<StageTiming>& timings, const std::filesystem::path& file);

}  // namespace parkade
