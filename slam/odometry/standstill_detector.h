#pragma once

#include <deque>
#include <vector>

#include "core/rig.h"
#include "slam/factors/sample_buffer.h"
#include "slam/tracking/feature_track.h"

namespace parkade {

struct StandstillOptions {
  double wheel_speed = 0.02;  ///< [m/s] wheels slower than this stand
  double image_motion =
      1.0e-3;  ///< [rad] median motion of tracks over `image_interval` that is still noise
  double image_interval = 0.5;  ///< [s]
  double gyroscope_deviation =
      0.01;  ///< [rad/s] spread of a resting gyroscope, or 3 sigma of its noise
  double accelerometer_deviation =
      0.15;  ///< [m/s^2] spread of a resting accelerometer, or 3 sigma of its noise
  void Validate() const;
};

/// Says whether the car stood over an interval: the wheels do not turn and the
/// gyroscope is quiet; without wheels, the images stand still and the whole IMU is
/// quiet. Traffic that fills one camera does not matter: it takes the median
/// track of the quietest camera against wheels, and three quarters of the tracks of every camera
/// without: tracks that move with the car, as its shadow's do, must not pass for the world.
class StandstillDetector {
 public:
  StandstillDetector(const ImuCalibration& imu, size_t num_cameras,
                     const StandstillOptions& options);

  void Add(const TrackedFrame& frame);

  /// Whether the car stood from `begin` to `end`, which must be later and should be by 0.1 s. `imu`
  /// is not empty. `was_still`: the car stood just before; it then takes more to believe that it
  /// moves, and no images are no reason to.
  bool IsStill(const ImuBuffer& imu, const WheelBuffer& wheels, Timestamp begin, Timestamp end,
               bool was_still = false) const;

 private:
  struct ImageMotion {
    Timestamp time;
    double median = 0;  ///< [rad]
    double most = 0;    ///< [rad] a quarter of the tracks moves more
    double sigma = 0;   ///< [rad] of a bearing
  };
  enum class Images { kUnknown, kStill, kMoving };

  Images ImagesDuring(Timestamp begin, Timestamp end, bool is_any_enough, double tolerance) const;

  StandstillOptions options_;
  double max_gyroscope_deviation_;
  double max_accelerometer_deviation_;
  double max_change_of_force_;                    ///< [m/s^2]
  std::vector<std::deque<TrackedFrame>> recent_;  ///< per camera, over `image_interval`
  std::vector<std::deque<ImageMotion>> motions_;  ///< per camera, the last second
};

}  // namespace parkade
