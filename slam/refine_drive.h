#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/adjustment_statistics.h"
#include "slam/align_to_gnss.h"
#include "slam/bending_modes.h"
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

/// What a drive's GNSS said.
struct GnssPositions {
  std::vector<GnssFix> fixes = {};
  Eigen::Vector3d antenna_in_body = Eigen::Vector3d::Zero();  ///< [m] lever arm
  GnssAlignOptions options = {};
};

/// Reads them from the log; the antenna is where the rig has it.
GnssPositions ReadGnss(const DriveLog& log, const GnssAlignOptions& options);

/// A drive after all its measurements were adjusted at once, or why it stays as it was.
struct DriveRefinement {
  Trajectory odom_from_body;  ///< refined where accepted, else as it was given; with the covariances of `modes`
  Rig rig;                    ///< likewise
  BendingModes modes;         ///< how it may be off; empty where not accepted, in pieces, or not determined
  bool is_accepted = false;
  std::string reason;  ///< why not accepted
  AdjustmentStatistics before, after;
  std::vector<CameraRefinement> cameras;
  double wheel_scale = 1;  ///< true speed / reported speed
  size_t num_knots = 0;
  int num_fixes = 0;  ///< of GNSS; 0 where they do not fix the heading
  int num_loops = 0, num_held_out = 0, num_pieces = 0, num_iterations = 0;
  double largest_correction = 0;  ///< [m] against what was given
  double seconds = 0;             ///< of computing
};

/// Batch adjustment of a drive (IMU, wheels, bearings, calibration, accepted loops, GNSS), warm-started from the pose
/// graph.
/// A share of the tracks, and of the loops where there are enough, is held out at first; only where the tracks fit
/// the poses better than before, the loops' error stays within what they claim or does not grow, and the IMU still
/// agrees is the result taken, and they join in a last solve. `rig` is what the log says. Nothing is done, with a
/// reason, where a mount turned during the drive.
DriveRefinement RefineDrive(const OdometryResult& odometry, const Rig& rig, const LoopClosure& closure,
                            const RefinementOptions& options, const GnssPositions& gnss = {});

nlohmann::json ToJson(const DriveRefinement& refinement);

}  // namespace parkade
