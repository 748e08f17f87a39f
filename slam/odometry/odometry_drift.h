#pragma once

#include "core/trajectory.h"

namespace parkade {

/// A random walk over the way driven: sigma = value * sqrt(meters).
struct OdometryDrift {
  double translation = 0;  ///< [m / sqrt(m)]
  double yaw = 0;          ///< [rad / sqrt(m)]
};

/// The random walk that ends with the covariance that the odometry itself gives for its last pose,
/// seen from its first. Zero where it gives none. Errors that the whole way shares, as one of
/// scale, are in it too.
OdometryDrift DriftOf(const Trajectory& odom_from_body);

}  // namespace parkade
