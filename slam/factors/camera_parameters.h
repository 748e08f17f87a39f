#pragma once

#include <array>

#include "slam/factors/node_parameters.h"

namespace parkade {

// What the smoother estimates of a camera's calibration is two parameter blocks:
//   extrinsics 7: imu_from_camera as a pose block (node_parameters.h); tangent 6
//   timing     2: [time offset s | line delay s/row]
// The time offset comes on top of the rig's: t_imu = stamp + offset.

inline constexpr int kTimingSize = 2;

struct CameraParameters {
  std::array<double, kPoseSize> extrinsics{};
  std::array<double, kTimingSize> timing{};

  Rigid3 ImuFromCamera() const { return PoseFromParameters(extrinsics.data()); }
  double time_offset() const { return timing[0]; }
  double line_delay() const { return timing[1]; }
};

/// Standard deviations of a camera's calibration.
struct CameraSigmas {
  double rotation = 0;     ///< [rad] per axis
  double translation = 0;  ///< [m] per axis
  double time_offset = 0;  ///< [s]
  double line_delay = 0;   ///< [s/row]
};

}  // namespace parkade
