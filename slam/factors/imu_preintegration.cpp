#include "slam/factors/imu_preintegration.h"

#include <cassert>
#include <utility>

#include "slam/factors/imu_noise.h"

namespace parkade {
namespace {

// A step this many times longer than the nominal period is a gap: what the car
// did in it is not known to the sensor's noise but to these deviations.
constexpr double kGapPeriods = 4;
constexpr double kGapAngularVelocity = 0.1;     // [rad/s]
constexpr double kGapLinearAcceleration = 1.0;  // [m/s^2]

Eigen::Vector3d RotationOverHalfStep(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                                     double step) {
  return RotationOverStep(begin, 0.5 * (begin + end), 0.5 * step);
}

}  // namespace

Eigen::Vector3d RotationOverStep(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                                 double step) {
  return 0.5 * step * (begin + end) + step * step / 12 * begin.cross(end);
}

void Advance(MotionIncrement& increment, const ImuSample& from, const ImuSample& to,
             const ImuBias& bias) {
  const double step = to.time - from.time;
  const Eigen::Vector3d w0 = from.angular_velocity - bias.gyroscope;
  const Eigen::Vector3d w1 = to.angular_velocity - bias.gyroscope;
  const Eigen::Vector3d a0 = from.linear_acceleration - bias.accelerometer;
  const Eigen::Vector3d a1 = to.linear_acceleration - bias.accelerometer;
  const Eigen::Quaterniond middle = increment.rotation * ExpSo3(RotationOverHalfStep(w0, w1, step));
  const Eigen::Quaterniond end =
      (increment.rotation * ExpSo3(RotationOverStep(w0, w1, step))).normalized();
  const Eigen::Vector3d f0 = increment.rotation * a0;
  const Eigen::Vector3d fm = middle * (0.5 * (a0 + a1));
  const Eigen::Vector3d f1 = end * a1;
  increment.position += increment.velocity * step + step * step / 6 * (f0 + 2 * fm);
  increment.velocity += step / 6 * (f0 + 4 * fm + f1);
  increment.rotation = end;
  increment.duration += step;
}

MotionIncrement Integrate(std::span<const ImuSample> samples, const ImuBias& bias) {
  MotionIncrement increment;
  for (size_t i = 1; i < samples.size(); ++i) Advance(increment, samples[i - 1], samples[i], bias);
  return increment;
}

MotionState Propagate(const MotionState& state, const MotionIncrement& increment) {
  const double t = increment.duration;
  const Eigen::Quaterniond& rotation = state.odom_from_imu.rotation;
  MotionState end = state;
  end.time = state.time + t;
  end.odom_from_imu.rotation = (rotation * increment.rotation).normalized();
  end.odom_from_imu.translation +=
      state.velocity_in_odom * t + 0.5 * t * t * kGravityInOdom + rotation * increment.position;
  end.velocity_in_odom += t * kGravityInOdom + rotation * increment.velocity;
  return end;
}

MotionState PropagateBack(const MotionState& state, const MotionIncrement& increment) {
  const double t = increment.duration;
  const Eigen::Quaterniond rotation =
      (state.odom_from_imu.rotation * increment.rotation.conjugate()).normalized();
  MotionState begin = state;
  begin.time = state.time - t;
  begin.odom_from_imu.rotation = rotation;
  begin.velocity_in_odom -= t * kGravityInOdom + rotation * increment.velocity;
  begin.odom_from_imu.translation -=
      begin.velocity_in_odom * t + 0.5 * t * t * kGravityInOdom + rotation * increment.position;
  return begin;
}

ImuPreintegration::ImuPreintegration(std::vector<ImuSample> samples, const ImuBias& bias,
                                     const ImuCalibration& calibration)
    : samples_(std::move(samples)), calibration_(WithMeasuredNoise(calibration, samples_)) {
  assert(samples_.size() >= 2);
  Reintegrate(bias);
}

void ImuPreintegration::Reintegrate(const ImuBias& bias) {
  bias_ = bias;
  increment_ = {};
  covariance_.setZero();
  d_gyroscope_.setZero();
  d_accelerometer_.setZero();
  for (size_t i = 1; i < samples_.size(); ++i) Step(samples_[i - 1], samples_[i]);
}

void ImuPreintegration::Step(const ImuSample& from, const ImuSample& to) {
  const double step = to.time - from.time;
  const Eigen::Vector3d w0 = from.angular_velocity - bias_.gyroscope;
  const Eigen::Vector3d w1 = to.angular_velocity - bias_.gyroscope;
  const Eigen::Vector3d force =
      0.5 * (from.linear_acceleration + to.linear_acceleration) - bias_.accelerometer;
  const Eigen::Vector3d turn = RotationOverStep(w0, w1, step);
  const Eigen::Matrix3d half_turn = ExpSo3(RotationOverHalfStep(w0, w1, step)).toRotationMatrix();
  const Eigen::Matrix3d middle = increment_.rotation.toRotationMatrix() * half_turn;
  // d (rotated force at the middle) by the rotation there and by its noise.
  const Eigen::Matrix3d d_force = -middle * Skew(force);

  Matrix9d transition = Matrix9d::Identity();
  transition.block<3, 3>(0, 0) = ExpSo3(turn).toRotationMatrix().transpose();
  transition.block<3, 3>(3, 0) = step * d_force * half_turn.transpose();
  transition.block<3, 3>(6, 0) = 0.5 * step * transition.block<3, 3>(3, 0);
  transition.block<3, 3>(6, 3) = step * Eigen::Matrix3d::Identity();

  Eigen::Matrix<double, 9, 3> by_gyroscope;
  by_gyroscope.topRows<3>() = -step * RightJacobianSo3(turn);
  by_gyroscope.middleRows<3>(3) = -0.5 * step * step * d_force;
  by_gyroscope.bottomRows<3>() = 0.5 * step * by_gyroscope.middleRows<3>(3);
  Eigen::Matrix<double, 9, 3> by_accelerometer;
  by_accelerometer.topRows<3>().setZero();
  by_accelerometer.middleRows<3>(3) = -step * middle;
  by_accelerometer.bottomRows<3>() = -0.5 * step * step * middle;

  double gyroscope_variance = std::pow(calibration_.gyroscope_noise_density, 2) / step;
  double accelerometer_variance = std::pow(calibration_.accelerometer_noise_density, 2) / step;
  if (step * calibration_.update_rate > kGapPeriods) {
    gyroscope_variance += kGapAngularVelocity * kGapAngularVelocity;
    accelerometer_variance += kGapLinearAcceleration * kGapLinearAcceleration;
  }
  covariance_ = transition * covariance_ * transition.transpose() +
                gyroscope_variance * by_gyroscope * by_gyroscope.transpose() +
                accelerometer_variance * by_accelerometer * by_accelerometer.transpose();
  d_gyroscope_ = transition * d_gyroscope_ + by_gyroscope;
  d_accelerometer_ = transition * d_accelerometer_ + by_accelerometer;
  Advance(increment_, from, to, bias_);
}

MotionIncrement ImuPreintegration::Corrected(const ImuBias& bias) const {
  const Eigen::Vector3d by_gyroscope = bias.gyroscope - bias_.gyroscope;
  const Eigen::Vector3d by_accelerometer = bias.accelerometer - bias_.accelerometer;
  const Eigen::Matrix<double, 9, 1> change =
      d_gyroscope_ * by_gyroscope + d_accelerometer_ * by_accelerometer;
  MotionIncrement corrected = increment_;
  corrected.rotation = (increment_.rotation * ExpSo3(change.head<3>())).normalized();
  corrected.velocity += change.segment<3>(3);
  corrected.position += change.tail<3>();
  return corrected;
}

}  // namespace parkade
