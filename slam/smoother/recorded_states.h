#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "slam/factors/camera_parameters.h"
#include "slam/factors/image_pose.h"
#include "slam/factors/imu_preintegration.h"
#include "slam/factors/motion_state.h"
#include "slam/factors/node_parameters.h"
#include "slam/factors/wheel_preintegration.h"

namespace parkade {

/// An observation of a tracked point, as small as it can be kept for a whole drive.
struct RecordedObservation {
  std::int64_t track = 0;
  Eigen::Vector3f bearing;  ///< unit, in the camera
  float sigma = 0;          ///< [rad] as the tracker declares it
  float row = 0;            ///< [px] below the middle of the image
};

/// An image that the odometry used.
struct RecordedImage {
  Timestamp time;  ///< with `time_offset`
  int camera = 0;
  double time_offset = 0;  ///< [s] on top of the rig's, with which `interpolation` was made
  std::int64_t first_node = 0;
  std::optional<std::int64_t> second_node;  ///< empty: the image is at the first node
  NodeInterpolation interpolation;
  Eigen::Vector3d angular_velocity =
      Eigen::Vector3d::Zero();  ///< [rad/s] as the gyroscope says, bias included
  std::vector<RecordedObservation> observations;
};

/// What a NodeInterval is made from.
struct RecordedInterval {
  std::vector<ImuSample> samples;
  ImuBias bias;
  std::optional<WheelPreintegration> wheels;
  bool is_still = false;
};

/// A state of the drive.
struct RecordedNode {
  std::int64_t number = 0;
  MotionState state;
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< [rotation in imu, position]
};

/// What odometry found of the things that all nodes share.
struct SharedFindings {
  std::vector<CameraParameters> cameras;
  std::vector<CameraSigmas>
      camera_priors;  ///< how far off the rig may be; 0 of what was not estimated
  std::vector<double> camera_noise_scales;  ///< noise found / noise declared
  double wheel_scale = 0;                   ///< error of the reported speed, relative
  bool has_jumps = false;  ///< a mount turned: one calibration does not hold for the whole drive
};

}  // namespace parkade
