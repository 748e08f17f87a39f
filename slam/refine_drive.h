#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/adjustment_statistics.h"
#include "slam/close_loops.h"
#include "slam/odometry_result.h"
#include "slam/refinement_options.h"

namespace parkade {

/// What became of one camera's calibration.
struct CameraRefinement {
  std::string name;
  double rotation = 0;     ///< [rad] against what odometry had found
  double translation = 0;  ///< [m] likewise
  double time_offset = 0;  ///< [s] likewise
  bool is_taken = false;   ///< odometry had found the quantity observable, so the change is taken
};

/// A drive after all its measurements were adjusted at once, or why it stays as it was.
struct DriveRefinement {
  Trajectory odom_from_body;  ///< refined where accepted, else as it was given
  Rig rig;                    ///< likewise
  bool is_accepted = false;
  std::string reason;  ///< why not accepted
  AdjustmentStatistics before, after;
  std::vector<CameraRefinement> cameras;
  double wheel_scale = 1;  ///< true speed / reported speed
  size_t num_knots = 0;
  int num_loops = 0, num_held_out = 0, num_pieces = 0, num_iterations = 0;
  double largest_correction = 0;  ///< [m] against what was given
  double seconds = 0;             ///< of computing
};

/// Batch adjustment of a drive (IMU, wheels, bearings, calibration, accepted loops), warm-started from the pose graph.
/// A share of the loops is held out at first; only where their error stays within what they claim, or does not grow,
/// and the IMU still agrees is the result taken, and they join in a last solve. `rig` is what the log says. Nothing is
/// done, with a reason, without enough loops or where a mount turned during the drive.
DriveRefinement RefineDrive(const OdometryResult& odometry, const Rig& rig, const LoopClosure& closure,
                            const RefinementOptions& options);

nlohmann::json ToJson(const DriveRefinement& refinement);

}  // namespace parkade
