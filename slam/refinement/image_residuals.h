#pragma once

#include <vector>

#include "core/rig.h"
#include "core/trajectory.h"
#include "slam/refinement/refinement_options.h"

namespace parkade {

class DriveMeasurements;

/// How well one image agrees with a drive's poses.
struct ImageResidual {
  Timestamp time;
  int camera = 0;
  int num_inliers = 0;  ///< bearings that meet those of other images
  double rms = 0;       ///< [rad] of these, off the points where they meet; 0 without any
};

/// Holds every image that the odometry used against a trajectory and a calibration, in order of the
/// images: points are where the bearings of a track meet best from these poses, and the residual is
/// what a bearing is off its point. Each image has as many tracks as a refinement takes.
///
/// \param log_rig  the log's, from whose time shifts `rig` differs
/// \param rig      with which `odom_from_body` was estimated
std::vector<ImageResidual> ResidualsOfImages(const DriveMeasurements& measurements,
                                             const Rig& log_rig, const Rig& rig,
                                             const Trajectory& odom_from_body,
                                             RefinementOptions options);

}  // namespace parkade
