#pragma once

#include <vector>

#include "core/rig.h"
#include "slam/factors/sample_buffer.h"
#include "slam/initialization/start_adjustment.h"
#include "slam/tracking/feature_track.h"

namespace parkade {

/// Images and tracks between `begin` and `end` (within the IMU's span): a dozen images of each
/// camera, the tracks that live longest in each, without points yet.
StartProblem CollectStartProblem(const ImuBuffer& imu, const std::vector<TrackedFrame>& frames,
                                 const Rig& rig, const GyroscopeBiasEstimate& bias, Timestamp begin,
                                 Timestamp end);

/// [m/s^2] down, in the IMU frame at the begin, if the speed were constant: minus the mean force.
Eigen::Vector3d MeanGravity(const ImuBuffer& imu, const ImuBias& bias, Timestamp begin,
                            Timestamp end);

/// What the ground says about the scale of the points: most of what cameras see below them lies at
/// their own height.
struct GroundScale {
  double log_scale = 0;  ///< by which points and way have to grow
  double sigma = 0;      ///< of that
  int num_points = 0;
};

/// For points that Adjust placed; nothing where the rig does not know the ground or no height
/// stands out.
std::optional<GroundScale> MeasureGroundScale(const StartProblem& problem, const Rig& rig);

}  // namespace parkade
