#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"

namespace parkade {

struct VisiblePointsOptions {
  double max_distance = 12;  ///< [m] of the ground to the camera

  void Validate() const;  ///< throws Error{kUsage}
};

/// Which points of a true ground the drive's cameras saw as drivable: those that project, from the
/// true pose, next to a drivable pixel of a mask of the log (`<camera>/semantic`), at most one
/// pixel off. A point just behind an obstacle therefore counts as seen, one further behind does
/// not. \param log             with the true rig \param world_from_imu  true poses, in the frame of
/// the points Throws Error{kInvalidInput} where the log has no masks. One pass over the log, masks
/// only.
std::vector<bool> FindVisiblePoints(const std::vector<Eigen::Vector3d>& points, const DriveLog& log,
                                    std::span<const TimedPose> world_from_imu,
                                    const VisiblePointsOptions& options = {});

/// The poses of a TUM file of a drive as its trajectory: poses are of the IMU, states of the body.
Trajectory TrajectoryOf(std::span<const TimedPose> world_from_imu, const Rig& rig);

}  // namespace parkade
