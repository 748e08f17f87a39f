#pragma once

#include <optional>
#include <vector>

#include "slam/smoother/smoother_window.h"

namespace parkade {

/// A node that left the window, and the landmarks that left with it.
struct MarginalizedNode {
  FinishedNode node;  ///< without covariance, and without what was reopened before it
  std::vector<FinishedLandmark> landmarks;
};

/// Condenses the oldest node of at least two, and the landmarks first seen from it, into the prior,
/// and removes it with its images.
MarginalizedNode MarginalizeOldest(SmootherWindow& window);

/// The covariance of the first pose that the prior speaks of, [rotation in imu, position in odom];
/// nothing where it is not determined.
std::optional<Eigen::Matrix<double, 6, 6>> CovarianceOfFirstPose(const LinearPrior& prior);

}  // namespace parkade
