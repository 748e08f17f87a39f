#pragma once

#include <Eigen/Core>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/landmark.h"
#include "core/rig.h"
#include "core/trajectory.h"

namespace parkade {

class DriveMeasurements;

/// An image worth keeping.
struct OdometryKeyframe {
  Timestamp time;  ///< of the refined rig: CalibratedLog delivers the image at exactly that time
  int camera = 0;
  Rigid3 odom_from_body;
};

/// A stretch of the drive that is less sure than the rest, and why.
struct DegradedInterval {
  Timestamp begin, end;
  std::string reason;
};

/// How the reason begins where no camera saw anything.
inline constexpr const char* kNoCamera = "no camera sees anything";

struct CameraHealth {
  std::string name;
  int frames = 0;               ///< delivered by the log
  int frames_used = 0;          ///< observed by the estimator
  int frames_rejected = 0;      ///< blank, of the wrong size, repeated
  double tracks_per_frame = 0;  ///< mean, in the frames used
  double noise_scale = 1;       ///< noise found / noise declared
};

/// One quantity of a camera's calibration, and what the drive says about it.
struct CalibratedQuantity {
  enum class Status { kKept, kPartlyRefined, kRefined };
  std::string name;        ///< "rotation" [rad, in the camera], "translation" [m, in the imu], ...
  Eigen::VectorXd change;  ///< refined - rig's, zero along directions that were kept
  Eigen::VectorXd sigma;   ///< of the estimate; of the prior where it was not estimated
  Status status = Status::kKept;
};

struct CameraCalibration {
  std::string name;  ///< of the camera
  std::vector<CalibratedQuantity>
      quantities;  ///< rotation, translation, time_offset [s], line_delay [s/row]
};

/// How the odometry went; goes into report.json.
struct OdometryReport {
  std::string start_kind;  ///< "standstill", "rolling on wheels", "moving in images"
  double start_time = 0;   ///< [s] after the log's begin, of the first estimated state
  double start_data = 0;   ///< [s] of data it took
  std::vector<CameraHealth> cameras;
  std::vector<CameraCalibration> calibration;  ///< per camera
  std::vector<DegradedInterval> degraded;
  int nodes = 0;
  int solves = 0;
  double mean_solve_seconds = 0, max_solve_seconds = 0;
  double mean_bearings = 0;  ///< per solve
  double seconds = 0;        ///< of computing, in total
  double length = 0;         ///< [m]
  double still_seconds = 0;  ///< [s] during which the car stood
  bool has_wheels = false;
  double wheel_scale = 1;       ///< true speed / reported speed, estimated
  std::string wheels_left_out;  ///< why: "are in km/h, as it seems: ..."; empty where they are not
  Eigen::Vector3d gyroscope_bias = Eigen::Vector3d::Zero();      ///< [rad/s] at the end
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< [m/s^2] at the end
};

struct OdometryResult {
  Trajectory odom_from_body;                ///< over the whole log, 20 Hz or more, gravity-aligned
  std::vector<OdometryKeyframe> keyframes;  ///< in order of time
  std::vector<Landmark> landmarks;          ///< in order of time
  Rig rig;                                  ///< the drive's, with what was refined
  OdometryReport report;
  std::shared_ptr<const DriveMeasurements> measurements;  ///< all of them, see drive_measurements.h
};

std::string ToText(CalibratedQuantity::Status status);

nlohmann::json ToJson(const OdometryReport& report);

}  // namespace parkade
