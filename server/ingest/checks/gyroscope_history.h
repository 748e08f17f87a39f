#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/drive_log.h"

namespace parkade {

/// What a gyroscope says over a drive.
class GyroscopeHistory {
 public:
  void Include(const ImuSample& sample) {
    rates_.push_back({sample.time, sample.angular_velocity});
  }

  /// The same without a bias [rad/s].
  GyroscopeHistory Without(const Eigen::Vector3d& bias) const;

  /// The rate [rad/s] at a time, in imu, between those read before and behind it; zero where there
  /// is none behind it.
  Eigen::Vector3d RateAt(Timestamp time) const;

  /// first_from_second of the IMU, by the trapezoids of its rates; nothing where more than 0.1 s is
  /// missing. Times must not decrease from call to call with the same `hint`.
  std::optional<Eigen::Quaterniond> Rotation(Timestamp first, Timestamp second,
                                             std::size_t& hint) const;

 private:
  struct Rate {
    Timestamp time;
    Eigen::Vector3d rate;  ///< [rad/s] in imu
  };

  std::vector<Rate> rates_;
};

}  // namespace parkade
