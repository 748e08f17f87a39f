#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"
#include "slam/georeference/align_to_gnss.h"
#include "slam/refinement/adjustment_statistics.h"
#include "slam/refinement/covariance_modes.h"

namespace parkade {

/// What became of one camera's calibration.
struct CameraRefinement {
  std::string name;
  double rotation = 0;     ///< [rad] against what odometry had found
  double translation = 0;  ///< [m] against what odometry had found
  double time_offset = 0;  ///< [s] against what odometry had found
  bool is_taken = false;   ///< odometry had found the quantity observable, so the change is taken
};

/// What a drive's GNSS said.
struct GnssPositions {
  std::vector<GnssFix> fixes = {};
  Eigen::Vector3d antenna_in_body = Eigen::Vector3d::Zero();  ///< [m] lever arm
  GnssAlignOptions options = {};
};

/// A drive after all its measurements were adjusted at once, or why it stays as it was.
struct DriveRefinement {
  Trajectory odom_from_body;  ///< refined where accepted, else as it was given; with the
                              ///< covariances of `modes`
  Rig rig;                    ///< refined where accepted, else as it was given
  CovarianceModes
      modes;  ///< how it may be off; empty where not accepted, in pieces, or not determined
  bool is_accepted = false;
  std::string reason;  ///< why not accepted
  AdjustmentStatistics before, after;
  std::vector<CameraRefinement> cameras;
  double wheel_scale = 1;  ///< true speed / reported speed
  size_t num_nodes = 0;
  int num_fixes = 0;  ///< of GNSS; 0 where they do not fix the heading
  int num_loops = 0, num_held_out = 0, num_pieces = 0, num_iterations = 0;
  double largest_correction = 0;  ///< [m] against what was given
  double seconds = 0;             ///< of computing
};

nlohmann::json ToJson(const DriveRefinement& refinement);

}  // namespace parkade
