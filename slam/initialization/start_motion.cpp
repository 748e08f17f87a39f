#include "slam/initialization/start_motion.h"

#include <cmath>

#include "core/math/decompositions.h"
#include "slam/factors/imu_preintegration.h"
#include "slam/factors/wheel_preintegration.h"

namespace parkade {
namespace {

constexpr double kMaxGravityError = 0.6;  // [m/s^2] of the norm found
constexpr double kRestTilt = 0.02;        // [rad] accelerometer bias / g
constexpr double kRegressionStep = 0.02;  // [s]
constexpr double kUnknownBias = 0.1;  // [m/s^2] accelerometer bias that tilts what we take for down

double MinBiasSigma(double sigma) { return std::max(sigma, 1e-4); }

}  // namespace

std::string ToText(StartKind kind) {
  switch (kind) {
    case StartKind::kStandstill: return "standstill";
    case StartKind::kRollingOnWheels: return "rolling on wheels";
    case StartKind::kMovingInImages: return "moving in images";
  }
  return "unknown";
}

Eigen::Quaterniond LeveledRotation(const Eigen::Vector3d& gravity_in_imu) {
  const Eigen::Quaterniond level = RotationBetween(-gravity_in_imu, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d forward = level * Eigen::Vector3d::UnitX();
  if (forward.head<2>().norm() < 1e-3) return level.normalized();
  const double heading = std::atan2(forward.y(), forward.x());
  return (Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()) * level).normalized();
}

std::optional<StartEstimate> StartFromStandstill(const ImuBuffer& imu,
                                                 const ImuCalibration& calibration, Timestamp begin,
                                                 Timestamp end) {
  const std::vector<ImuSample> samples = imu.Between(begin, end);
  Eigen::Vector3d rate = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) {
    rate += sample.angular_velocity;
    force += sample.linear_acceleration;
  }
  rate /= static_cast<double>(samples.size());
  force /= static_cast<double>(samples.size());
  if (std::abs(force.norm() + kGravityInOdom.z()) > kMaxGravityError) return std::nullopt;
  StartEstimate start;
  start.kind = StartKind::kStandstill;
  start.state.time = begin;
  start.state.gyroscope_bias = rate;
  start.state.odom_from_imu.rotation = LeveledRotation(-force);
  start.uncertainty = {
      kRestTilt, 0.01,
      MinBiasSigma(3 * calibration.gyroscope_noise_density / std::sqrt(end - begin)), kUnknownBias};
  return start;
}

std::optional<StartEstimate> StartFromWheels(const ImuBuffer& imu, const WheelBuffer& wheels,
                                             const Rig& rig, const GyroscopeBiasEstimate& bias,
                                             Timestamp begin, Timestamp end) {
  if (wheels.LongestGap(begin, end) > kMaxWheelGap) return std::nullopt;
  const Rigid3 imu_from_body = rig.body_from_imu.Inverse();
  const auto velocity_at = [&](Timestamp time) -> Eigen::Vector3d {
    const Eigen::Vector3d rate = imu.At(time).angular_velocity - bias.bias;
    return imu_from_body.rotation * Eigen::Vector3d(wheels.At(time).forward_speed, 0, 0) -
           rate.cross(imu_from_body.translation);
  };
  // Linear regression of R(t) v(t) - dv(t) = v_0 + g t.
  const ImuBias imu_bias{bias.bias, Eigen::Vector3d::Zero()};
  double n = 0, sum_t = 0, sum_tt = 0;
  Eigen::Vector3d sum_y = Eigen::Vector3d::Zero(), sum_ty = Eigen::Vector3d::Zero();
  MotionIncrement increment;
  ImuSample last = imu.At(begin);
  for (int k = 0; begin + k * kRegressionStep <= end; ++k) {
    const Timestamp time = begin + k * kRegressionStep;
    if (k > 0) {
      const std::vector<ImuSample> samples = imu.Between(last.time, time);
      for (size_t i = 1; i < samples.size(); ++i)
        Advance(increment, samples[i - 1], samples[i], imu_bias);
      last = samples.back();
    }
    const Eigen::Vector3d y = increment.rotation * velocity_at(time) - increment.velocity;
    const double t = time - begin;
    n += 1;
    sum_t += t;
    sum_tt += t * t;
    sum_y += y;
    sum_ty += t * y;
  }
  const double determinant = n * sum_tt - sum_t * sum_t;
  if (!(determinant > 0)) return std::nullopt;
  const Eigen::Vector3d gravity = (n * sum_ty - sum_t * sum_y) / determinant;
  const Eigen::Vector3d velocity = (sum_tt * sum_y - sum_t * sum_ty) / determinant;
  if (std::abs(gravity.norm() + kGravityInOdom.z()) > kMaxGravityError) return std::nullopt;
  StartEstimate start;
  start.kind = StartKind::kRollingOnWheels;
  start.state.time = begin;
  start.state.gyroscope_bias = bias.bias;
  start.state.odom_from_imu.rotation = LeveledRotation(gravity);
  start.state.velocity_in_odom = start.state.odom_from_imu.rotation * velocity;
  start.uncertainty = {0.04, 0.15, MinBiasSigma(3 * bias.sigma), kUnknownBias};
  return start;
}

}  // namespace parkade
