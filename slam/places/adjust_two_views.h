#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/rigid3.h"

namespace parkade {

/// A point seen by two cameras: unit rays in each, and their sigmas [rad].
struct RayPair {
  Eigen::Vector3d in_a, in_b;
  double sigma_a = 1e-3, sigma_b = 1e-3;
};

/// How well rotation and direction between two cameras are known.
struct AdjustedTwoViews {
  Eigen::Matrix3d rotation_covariance =
      Eigen::Matrix3d::Identity();  ///< [rad^2] of a turn on the right
  double direction_sigma =
      1;  ///< [rad] of the direction, in the worst of its two ways; at most 1: nothing is known
};

/// Moves rotation and direction (a unit vector) to where the rays meet best: Gauss-Newton over five
/// degrees of freedom on epipolar errors e = t . (R b x a), each in units of its sigma, with Cauchy
/// weights. Fewer than six pairs leave the pose as it is, and nothing known.
AdjustedTwoViews AdjustTwoViews(const std::vector<RayPair>& pairs, Rigid3& a_from_b);

}  // namespace parkade
