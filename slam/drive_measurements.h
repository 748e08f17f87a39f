#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slam/smoother_window.h"

namespace parkade {

/// A sighting of a tracked point, as small as it can be kept for a whole drive.
struct RecordedSighting {
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
  std::int64_t first_knot = 0;
  std::optional<std::int64_t> second_knot;  ///< empty: the image is at the first knot
  KnotInterpolation interpolation;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< [rad/s] as the gyroscope says, bias included
  std::vector<RecordedSighting> sightings;
};

/// A state of the drive, and what IMU and wheels say about the way from the one before.
struct RecordedKnot {
  std::int64_t number = 0;
  MotionState state;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< [rotation in imu, position]
  std::optional<KnotInterval> interval;                                          ///< empty at the first
};

/// Everything the odometry measured, so that the whole drive can be adjusted at once. About 40 KB per second.
struct DriveMeasurements {
  std::vector<RecordedKnot> knots;    ///< in order, numbers without gaps
  std::vector<RecordedImage> images;  ///< in order of their first knot
  // What odometry found of the things that all knots share.
  std::vector<CameraParameters> cameras;
  std::vector<CameraSigmas> camera_priors;  ///< how far off the rig may be; 0 of what was not estimated
  std::vector<double> camera_noise_scales;  ///< noise found / noise declared
  double wheel_scale = 0;                   ///< error of the reported speed, relative
  bool has_jumps = false;                   ///< a mount turned: one calibration does not hold for the whole drive
};

}  // namespace parkade
