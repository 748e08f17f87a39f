#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slam/record_store.h"
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

/// What a KnotInterval is made from.
struct RecordedInterval {
  std::vector<ImuSample> samples;
  ImuBias bias;
  std::optional<WheelPreintegration> wheels;
  bool is_still = false;
};

/// A state of the drive.
struct RecordedKnot {
  std::int64_t number = 0;
  MotionState state;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< [rotation in imu, position]
};

/// What odometry found of the things that all knots share.
struct SharedFindings {
  std::vector<CameraParameters> cameras;
  std::vector<CameraSigmas> camera_priors;  ///< how far off the rig may be; 0 of what was not estimated
  std::vector<double> camera_noise_scales;  ///< noise found / noise declared
  double wheel_scale = 0;                   ///< error of the reported speed, relative
  bool has_jumps = false;                   ///< a mount turned: one calibration does not hold for the whole drive
};

/// Everything the odometry measured, so that the whole drive can be adjusted at once. It lies on disk, where the drive
/// may be as long as it likes; only the knots' states are in memory.
class DriveMeasurements {
 public:
  explicit DriveMeasurements(const ImuCalibration& imu) : imu_(imu) {}

  /// \param interval  what IMU and wheels say about the way from the knot before; empty at the first
  void AddKnot(const RecordedKnot& knot, const std::optional<KnotInterval>& interval);
  void AddKnot(const RecordedKnot& knot, std::optional<RecordedInterval> interval);
  /// In order of their first knot.
  void AddImage(RecordedImage image);

  // From disk, by index. Several threads may read at once.
  std::optional<KnotInterval> IntervalBefore(size_t knot) const;
  RecordedImage Image(size_t image) const;
  size_t num_images() const { return images_.size(); }
  // As BinaryWriter encodes std::optional<RecordedInterval> and RecordedImage.
  std::string IntervalBytes(size_t knot) const { return intervals_.Bytes(knot); }
  std::string ImageBytes(size_t image) const { return images_.Bytes(image); }

  std::vector<RecordedKnot> knots;  ///< in order, numbers without gaps; AddKnot adds, states may be corrected
  SharedFindings shared;

 private:
  ImuCalibration imu_;
  RecordStore<std::optional<RecordedInterval>> intervals_;
  RecordStore<RecordedImage> images_;
};

}  // namespace parkade
