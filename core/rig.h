#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/field_map.h"
#include "core/rigid3.h"

namespace parkade {

/// One camera of a rig. Cameras are not synchronized with each other.
struct RigCamera {
  std::string name;   ///< "cam0"; unique within the rig
  std::string topic;  ///< image topic; matched with or without "/compressed"
  CameraModel model;
  Rigid3 body_from_camera;
  double time_shift = 0;  ///< [s] t_imu = t_camera + time_shift
  double line_delay = 0;  ///< [s/row] rolling shutter; a stamp means mid exposure of the middle row
  cv::Mat mask;           ///< CV_8UC1 of the image's size, 0 = ignore; empty = use all

  /// Whether a pixel lies at least `margin` [px] inside the image, and the mask leaves it.
  bool IsUsable(const Eigen::Vector2d& pixel, double margin) const;
};

/// Continuous-time noise of the IMU, as in Kalibr's imu0.yaml.
struct ImuCalibration {
  std::string topic;
  double update_rate = 100;                   ///< [Hz]
  double accelerometer_noise_density = 2e-2;  ///< [m/s^2/sqrt(Hz)]
  double accelerometer_random_walk = 1e-3;    ///< [m/s^3/sqrt(Hz)]
  double gyroscope_noise_density = 1e-3;      ///< [rad/s/sqrt(Hz)]
  double gyroscope_random_walk = 1e-5;        ///< [rad/s^2/sqrt(Hz)]
  double accelerometer_scale = 1;             ///< [m/s^2] of one unit of the log's accelerations
  double gyroscope_scale = 1;                 ///< [rad/s] of one unit of the log's rates
};

/// What vehicle.yaml says about the car.
struct VehicleCalibration {
  double wheelbase = 0;  ///< [m]; 0 = not given
  double track = 0;      ///< [m]; 0 = not given
  std::string wheel_topic;
  std::string gnss_topic;
  double wheel_scale = 1;                          ///< [m/s] of one unit of the log's wheel speeds
  std::optional<Eigen::Vector3d> antenna_in_body;  ///< [m] GNSS antenna
  FieldMap fields = {};                            ///< sensors in messages of other types
};

/// The calibrated sensors of one car, valid once ValidateRig has passed.
/// Frame `body`: rear-axle center on the ground, x forward, y left, z up. Rigs
/// without vehicle.yaml have no such frame: body is then the IMU frame and
/// `vehicle` is empty.
struct Rig {
  std::vector<RigCamera> cameras;
  ImuCalibration imu;
  Rigid3 body_from_imu;
  std::optional<VehicleCalibration> vehicle;

  Rigid3 ImuFromCamera(size_t camera) const {
    return body_from_imu.Inverse() * cameras[camera].body_from_camera;
  }
};

/// Throws Error{kInvalidInput} naming the first thing that is wrong: no camera,
/// duplicate names or topics, non-finite numbers, non-positive noises, a mask
/// whose size differs from the image's.
void ValidateRig(const Rig& rig);

/// Reads a folder with camchain-imucam.yaml, imu0.yaml (or as FindRigFiles knows them) and
/// (optionally) vehicle.yaml, in Kalibr's conventions (docs/conventions.md), and validates.
/// Accepts a leading "%YAML:1.0". Throws Error{kInvalidInput}, naming file and key.
Rig ReadRig(const std::filesystem::path& folder);

/// Reads the three files in one, as a map has them for each drive (calibration.yaml): without
/// masks. Throws as ReadRig.
Rig ReadCalibration(const std::filesystem::path& file);

/// Writes the three files so that ReadRig gives the same rig to 1e-9.
void WriteRig(const Rig& rig, const std::filesystem::path& folder);

}  // namespace parkade
