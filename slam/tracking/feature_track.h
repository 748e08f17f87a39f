#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/timestamp.h"

namespace parkade {

/// One observation of a tracked point.
struct FeatureObservation {
  std::int64_t track = 0;   ///< the same number in every frame of the same camera that sees it
  Eigen::Vector2d pixel;    ///< [px] as recorded, distorted
  Eigen::Vector3d bearing;  ///< unit, in the camera frame
  double sigma = 0;         ///< [rad] of the bearing: pixel noise / local pixels per radian
};

/// What the front end found in one image.
struct TrackedFrame {
  Timestamp time;  ///< of the image, on the IMU's clock
  int camera = 0;
  std::vector<FeatureObservation> observations;  ///< tracked and new ones
  double time_offset = 0;  ///< [s] already added to `time` beyond the rig's, see CameraParameters
};

}  // namespace parkade
