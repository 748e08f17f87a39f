#pragma once

#include <Eigen/Core>

#include "core/timestamp.h"

namespace parkade {

/// A point that odometry triangulated.
struct Landmark {
  Timestamp time;                 ///< first seen
  int camera = 0;                 ///< that saw it first
  Eigen::Vector3d point_in_odom;  ///< [m]
  double sigma = 0;               ///< [m] along the worst direction
  int num_observations = 0;
};

}  // namespace parkade
