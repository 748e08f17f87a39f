#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/close_loops.h"
#include "slam/refine_drive.h"
#include "tests/bench/odometry_table.h"

namespace parkade {

/// An accepted loop against the truth.
struct LoopError {
  double translation = 0;  ///< [m]
  double rotation = 0;     ///< [rad]
  int num_inliers = 0;
  bool is_opposite = false;  ///< the car stood the other way around
  double height = 0;         ///< [m] between the two places in truth
};

/// One drive, one way to close its loops, and what came of it.
struct LoopRun {
  std::string drive, scene, method;  ///< method: none, pnp, scale-less, rotation-only, rig, rig+refine
  double length = 0;                 ///< [m]
  double ate = 0, drift_percent = 0;
  int num_candidates = 0, num_measured = 0;  ///< measured: before the pose graph had its say
  std::vector<LoopError> accepted;
  int num_wrong = 0;                                     ///< accepted loops farther off than anything could excuse
  int num_opposite_chances = 0, num_opposite_found = 0;  ///< places that were passed before the other way around
  double seconds = 0;                                    ///< of closing loops or refining
  double odometry_seconds = 0, duration = 0;             ///< of tracking; of the drive
  DriveRefinement refinement;                            ///< of rig+refine
};

/// Tracks the drive once with the variant's rig and closes its loops in all ways.
std::vector<LoopRun> RunLoops(const SuiteDrive& drive, const TableVariant& variant, const OdometryOptions& odometry,
                              const LoopOptions& loops, const RefinementOptions& refinement);

nlohmann::json ToJson(const LoopRun& run);

/// A table like the paper's, one row per drive, and what it adds up to.
std::string ToMarkdown(const std::vector<LoopRun>& runs);

/// Histograms of the accepted loops' errors, one row per method: translation and rotation. CV_8UC3, for people.
cv::Mat PlotLoopErrors(const std::vector<LoopRun>& runs);

}  // namespace parkade
