#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <variant>

#include "core/rig.h"
#include "core/timestamp.h"

namespace parkade {

// All stamps are on the IMU's clock: a camera's time shift is already applied.

/// ONE image of ONE camera at its own time.
struct CameraFrame {
  Timestamp time;
  int camera = 0;  ///< index into Rig::cameras
  cv::Mat image;   ///< CV_8UC1 or CV_8UC3 (BGR), of the calibrated size
};

/// Drivable-ground mask that came with the log (`<camera>/semantic`).
struct SemanticFrame {
  Timestamp time;
  int camera = 0;
  cv::Mat mask;  ///< CV_8UC1, 255 = drivable
};

struct ImuSample {
  Timestamp time;
  Eigen::Vector3d angular_velocity;     ///< [rad/s] in imu
  Eigen::Vector3d linear_acceleration;  ///< [m/s^2] specific force in imu
};

/// Twist of the body frame from wheel odometry.
struct WheelSample {
  Timestamp time;
  double forward_speed = 0;  ///< [m/s] along body x
  double yaw_rate = 0;       ///< [rad/s] about body z
};

struct GnssFix {
  static constexpr double kUnknownAltitude = 1e5;  ///< [m] sigma of an altitude that nobody knows

  Timestamp time;
  double latitude_deg = 0, longitude_deg = 0;
  double altitude = 0;                                       ///< [m] above the WGS84 ellipsoid
  Eigen::Vector3d sigma_enu = Eigen::Vector3d::Constant(1);  ///< [m]

  bool HasAltitude() const { return sigma_enu.z() < kUnknownAltitude; }
};

using SensorRecord = std::variant<ImuSample, WheelSample, GnssFix, CameraFrame, SemanticFrame>;

Timestamp TimeOf(const SensorRecord& record);

/// What one pass over a log should deliver. Streams left out cost no decoding.
struct ReadOptions {
  bool imu = true, wheels = true, gnss = true, images = true, semantics = false;
  bool grayscale = true;  ///< images as CV_8UC1; false: as recorded (BGR where colored)
  /// Where set: only these images (and masks) are decoded and delivered.
  std::function<bool(int camera, Timestamp time)> wants_image;
};

/// One pass over a drive: records in order of time (`TimeOf` never decreases).
/// A record that is damaged, repeated, not finite, or later than the reordering
/// window is counted by the source and skipped.
class RecordStream {
 public:
  virtual ~RecordStream() = default;
  /// The next record, or nothing at the end. Call from one thread.
  virtual std::optional<SensorRecord> Next() = 0;
};

/// A handle on one recorded drive. Never the whole log in memory: each Read()
/// is a new pass in bounded memory. Implemented by server/ingest (files) and by
/// tests/support (synthetic drives).
class DriveLog {
 public:
  virtual ~DriveLog() = default;
  virtual const std::string& name() const = 0;
  virtual const Rig& rig() const = 0;
  virtual TimeSpan span() const = 0;
  virtual std::unique_ptr<RecordStream> Read(const ReadOptions& options) const = 0;
};

}  // namespace parkade
