#include "tests/simulator/sensors/imu_sensor.h"

#include <cmath>

#include "tests/simulator/common/drive_clock.h"

namespace parkade::simulator {
namespace {

constexpr double kBiasCorrelationTime = 3600;  // [s]

Eigen::Vector3d NormalVector(Random& random) {
  const double x = random.Normal(), y = random.Normal(), z = random.Normal();
  return {x, y, z};
}

Eigen::Matrix3d SensitivityMatrix(double scale_error, double misalignment, Random& random) {
  Eigen::Matrix3d matrix;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      matrix(row, column) =
          row == column ? 1 + scale_error * random.Normal() : misalignment * random.Normal();
  return matrix;
}

}  // namespace

ImuErrors::ImuErrors(const ImuGrade& grade, double rate, double strength, std::uint64_t seed)
    : strength_(strength),
      root_rate_(std::sqrt(rate)),
      keep_(std::exp(-1 / (kBiasCorrelationTime * rate))),
      grade_(grade),
      random_(seed, 0x14) {
  gyroscope_offset_ = strength * grade.gyroscope_bias * NormalVector(random_);
  accelerometer_offset_ = strength * grade.accelerometer_bias * NormalVector(random_);
  gyroscope_matrix_ =
      SensitivityMatrix(strength * grade.scale_error, strength * grade.misalignment, random_);
  accelerometer_matrix_ =
      SensitivityMatrix(strength * grade.scale_error, strength * grade.misalignment, random_);
}

ImuSample ImuErrors::Apply(const ImuSample& ideal) {
  gyroscope_walk_ =
      keep_ * gyroscope_walk_ + grade_.gyroscope_random_walk / root_rate_ * NormalVector(random_);
  accelerometer_walk_ = keep_ * accelerometer_walk_ +
                        grade_.accelerometer_random_walk / root_rate_ * NormalVector(random_);
  const Eigen::Vector3d gyroscope_error =
      gyroscope_walk_ + grade_.gyroscope_noise_density * root_rate_ * NormalVector(random_);
  const Eigen::Vector3d accelerometer_error =
      accelerometer_walk_ + grade_.accelerometer_noise_density * root_rate_ * NormalVector(random_);
  ImuSample sample = ideal;
  sample.angular_velocity =
      gyroscope_matrix_ * ideal.angular_velocity + gyroscope_offset_ + strength_ * gyroscope_error;
  sample.linear_acceleration = accelerometer_matrix_ * ideal.linear_acceleration +
                               accelerometer_offset_ + strength_ * accelerometer_error;
  return sample;
}

ImuSample IdealImuSample(const Motion& motion, const Rigid3& body_from_imu, Timestamp epoch,
                         Timestamp time) {
  const MotionState state = motion.At(time - epoch);
  const Eigen::Vector3d& w = state.angular_velocity_in_body;
  const Eigen::Vector3d& lever = body_from_imu.translation;
  const Eigen::Quaterniond body_from_world = state.world_from_body.rotation.conjugate();
  const Eigen::Vector3d upward(0, 0, kGravity);
  const Eigen::Vector3d force_in_body = body_from_world * (state.acceleration_in_world + upward) +
                                        state.angular_acceleration_in_body.cross(lever) +
                                        w.cross(w.cross(lever));
  const Eigen::Quaterniond imu_from_body = body_from_imu.rotation.conjugate();
  return {time, imu_from_body * w, imu_from_body * force_in_body};
}

std::vector<ImuSample> SimulateImu(const Motion& motion, const Rig& rig,
                                   const SensorOptions& options, std::uint64_t seed) {
  ImuErrors errors(ImuGradeNamed(options.imu), options.imu_rate, options.imu_noise, seed);
  std::vector<ImuSample> samples;
  for (const Timestamp time : Ticks(motion.Duration(), options.imu_rate, 0.0013, seed))
    samples.push_back(
        errors.Apply(IdealImuSample(motion, rig.body_from_imu, DriveEpoch(seed), time)));
  return samples;
}

}  // namespace parkade::simulator
