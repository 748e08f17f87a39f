#pragma once

#include <Eigen/Geometry>

#include "core/rigid3.h"

namespace parkade {

/// The same motion with its rotation as a matrix: for many points that takes a third of the time.
inline Eigen::Isometry3d IsometryOf(const Rigid3& motion) {
  Eigen::Isometry3d isometry(motion.rotation.toRotationMatrix());
  isometry.translation() = motion.translation;
  return isometry;
}

}  // namespace parkade
