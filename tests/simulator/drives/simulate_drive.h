#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/simulator/drives/progress_listener.h"
#include "tests/simulator/drives/simulate_options.h"

namespace parkade::simulator {

/// Where the results go.
struct OutputPaths {
  std::filesystem::path log;    ///< .bag, .mcap, or a folder
  std::filesystem::path rig;    ///< folder; empty: `truth`/rig
  std::filesystem::path truth;  ///< folder; empty: DefaultTruthFolder(log)
};

/// FILE.mcap -> FILE.truth beside it; a folder -> itself.
std::filesystem::path DefaultTruthFolder(const std::filesystem::path& log);

/// Makes a drive and writes the log, the rig as its owner knows it (rig/) and as it is (rig_true/,
/// and rig_true_knocked/ after a mirror was hit), truth.tum, ground_truth.ply, slots.geojson,
/// kerbs.geojson and summary.json, which it also returns. The same options give the same bytes, but
/// for the summary's timings. Throws Error{kUsage} for options that cannot be.
nlohmann::json SimulateDrive(const SimulateOptions& options, const OutputPaths& out,
                             const ProgressListener& progress);

}  // namespace parkade::simulator
