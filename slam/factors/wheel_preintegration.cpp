#include "slam/factors/wheel_preintegration.h"

#include <cassert>

#include "core/error.h"
#include "slam/factors/sample_buffer.h"

namespace parkade {
namespace {

double SpeedAt(std::span<const WheelSample> wheels, Timestamp time, size_t& next) {
  while (next + 1 < wheels.size() && wheels[next].time < time) ++next;
  if (next == 0 || wheels[next].time <= time) return wheels[next].forward_speed;
  return InterpolateSamples(wheels[next - 1], wheels[next], time).forward_speed;
}

}  // namespace

void WheelNoise::Validate() const {
  Require(forward_speed > 0 && lateral_speed > 0 && vertical_speed > 0 && correlation_time > 0 &&
              forward_fraction >= 0 && crosswise_fraction >= 0,
          ErrorCode::kUsage, "the noise of the wheels must be positive");
}

WheelPreintegration PreintegrateWheels(std::span<const ImuSample> imu,
                                       std::span<const WheelSample> wheels,
                                       const Eigen::Vector3d& gyroscope_bias,
                                       const Rigid3& imu_from_body, const WheelNoise& noise) {
  assert(imu.size() >= 2 && wheels.size() >= 2);
  WheelPreintegration result;
  result.gyroscope_bias = gyroscope_bias;
  result.body_in_imu = imu_from_body.translation;
  const Eigen::Vector3d forward = imu_from_body.rotation * Eigen::Vector3d::UnitX();

  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d d_rotation = Eigen::Matrix3d::Zero();
  size_t next = 0;
  Eigen::Vector3d last_velocity = SpeedAt(wheels, imu.front().time, next) * forward;
  Eigen::Matrix3d d_last_velocity = Eigen::Matrix3d::Zero();
  double distance = 0;
  for (size_t k = 1; k < imu.size(); ++k) {
    const double step = imu[k].time - imu[k - 1].time;
    const Eigen::Vector3d turn = RotationOverStep(imu[k - 1].angular_velocity - gyroscope_bias,
                                                  imu[k].angular_velocity - gyroscope_bias, step);
    rotation = (rotation * ExpSo3(turn)).normalized();
    d_rotation =
        ExpSo3(turn).toRotationMatrix().transpose() * d_rotation - step * RightJacobianSo3(turn);
    const double speed = SpeedAt(wheels, imu[k].time, next);
    const Eigen::Vector3d velocity = rotation * (speed * forward);
    const Eigen::Matrix3d d_velocity =
        -rotation.toRotationMatrix() * Skew(speed * forward) * d_rotation;
    result.displacement += 0.5 * step * (last_velocity + velocity);
    result.d_gyroscope_bias += 0.5 * step * (d_last_velocity + d_velocity);
    result.duration += step;
    distance += step * std::abs(speed);
    last_velocity = velocity;
    d_last_velocity = d_velocity;
  }

  const double speed = distance / result.duration;
  const double crosswise = std::pow(noise.crosswise_fraction * speed, 2);
  const Eigen::Vector3d speed_variance(
      std::pow(noise.forward_speed, 2) + std::pow(noise.forward_fraction * speed, 2),
      std::pow(noise.lateral_speed, 2) + crosswise, std::pow(noise.vertical_speed, 2) + crosswise);
  const Eigen::Matrix3d turned =
      Eigen::Quaterniond::Identity().slerp(0.5, rotation).toRotationMatrix() *
      imu_from_body.rotation.toRotationMatrix();
  const double time_squared =
      result.duration * std::max(noise.correlation_time, imu[1].time - imu[0].time);
  result.covariance = time_squared * turned * speed_variance.asDiagonal() * turned.transpose();
  return result;
}

}  // namespace parkade
