#pragma once

#include <array>

#include "slam/knot_parameters.h"

namespace parkade {

/// Where a knot's Jacobians are evaluated once a prior holds it: at the values
/// it had then, so that later re-linearisation does not make up information
/// along directions nobody can observe (yaw, position).
/// G. Huang et al., "A First-Estimates Jacobian EKF", ISER 2008.
struct FirstEstimate {
  bool is_fixed = false;
  std::array<double, kPoseSize> pose{};
  std::array<double, kMotionSize> motion{};

  /// The values to linearise at, given the current ones.
  const double* Pose(const double* current) const { return is_fixed ? pose.data() : current; }
  const double* Motion(const double* current) const { return is_fixed ? motion.data() : current; }
};

}  // namespace parkade
