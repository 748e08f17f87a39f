#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/rig.h"
#include "slam/factors/sample_buffer.h"
#include "slam/tracking/feature_track.h"

namespace parkade {

struct GyroscopeBiasEstimate {
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< [rad/s]
  double sigma = 0;                                ///< [rad/s] along the worst axis
};

/// Gyroscope bias from images alone, moving or not: with the right rotation
/// between two images of one camera the normals of all epipolar planes lie in
/// one plane. Minimizes, over the bias, the distance of all normals from the
/// best plane of each pair, robustly. Nothing when images say too little.
///
/// L. Kneip, S. Lynen, "Direct Optimization of Frame-to-Frame Rotation",
/// ICCV 2013; Y. He et al., "A Rotation-Translation-Decoupled Solution for
/// Robust and Efficient Visual-Inertial Initialization", CVPR 2023.
std::optional<GyroscopeBiasEstimate> EstimateGyroscopeBias(const std::vector<TrackedFrame>& frames,
                                                           const ImuBuffer& imu, const Rig& rig);

}  // namespace parkade
