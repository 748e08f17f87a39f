#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/rig.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/motion/motion.h"
#include "tests/simulator/sensors/imu_grade.h"
#include "tests/simulator/sensors/sensor_options.h"

namespace parkade::simulator {

inline constexpr double kGravity = 9.80665;  ///< [m/s^2]

/// Turns ideal samples into what a real IMU gives: scale, misalignment, a bias that begins at
/// random and walks (Gauss-Markov of an hour: a random walk over a drive, bounded over a day),
/// white noise.
class ImuErrors {
 public:
  /// `strength` scales every error; 0 leaves samples as they are. Samples come at `rate` [Hz].
  ImuErrors(const ImuGrade& grade, double rate, double strength, std::uint64_t seed);

  ImuSample Apply(const ImuSample& ideal);

 private:
  double strength_, root_rate_, keep_;
  ImuGrade grade_;
  Random random_;
  Eigen::Matrix3d gyroscope_matrix_, accelerometer_matrix_;
  Eigen::Vector3d gyroscope_offset_, accelerometer_offset_;  ///< of switching on
  Eigen::Vector3d gyroscope_walk_ = Eigen::Vector3d::Zero(),
                  accelerometer_walk_ = Eigen::Vector3d::Zero();
};

/// What an ideal IMU measures: angular velocity and specific force in imu.
ImuSample IdealImuSample(const Motion& motion, const Rigid3& body_from_imu, Timestamp epoch,
                         Timestamp time);

/// Over the whole motion, in order of time.
std::vector<ImuSample> SimulateImu(const Motion& motion, const Rig& rig,
                                   const SensorOptions& options, std::uint64_t seed);

}  // namespace parkade::simulator
