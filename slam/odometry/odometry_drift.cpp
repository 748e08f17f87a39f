#include "slam/odometry/odometry_drift.h"

#include <algorithm>
#include <cmath>

namespace parkade {

OdometryDrift DriftOf(const Trajectory& odom_from_body) {
  const auto& states = odom_from_body.states();
  const double length = odom_from_body.Length();
  if (states.empty() || !(length > 0)) return {};
  const TrajectoryState& last = states.back();
  // Yaw is the rotation along the vertical, which is e_z of odom rotated back into body.
  const Eigen::Vector3d up_in_body =
      last.world_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const double yaw_variance = up_in_body.dot(last.covariance.topLeftCorner<3, 3>() * up_in_body);
  const double position_variance = last.covariance.bottomRightCorner<3, 3>().trace() / 3;
  return {std::sqrt(std::max(0.0, position_variance) / length),
          std::sqrt(std::max(0.0, yaw_variance) / length)};
}

}  // namespace parkade
