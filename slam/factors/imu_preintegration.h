#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/drive_log.h"
#include "slam/factors/motion_state.h"

namespace parkade {

/// Gyroscope and accelerometer biases in [rad/s] and [m/s^2].
struct ImuBias {
  Eigen::Vector3d gyroscope = Eigen::Vector3d::Zero();
  Eigen::Vector3d accelerometer = Eigen::Vector3d::Zero();
};

/// Motion relative to the IMU frame at the start, gravity and initial velocity
/// left out: R_j = R_i dR, v_j = v_i + g t + R_i dv, p_j = p_i + v_i t + g t^2/2 + R_i dp.
struct MotionIncrement {
  double duration = 0;  ///< [s]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
};

/// Rotation over one step with an angular velocity that goes linearly from
/// `begin` to `end` [rad/s]: Magnus series to the third order in `step` [s].
Eigen::Vector3d RotationOverStep(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                                 double step);

/// Continues `increment` from one sample to the next: both vary linearly in
/// between, forces are integrated by Simpson's rule (fourth order).
void Advance(MotionIncrement& increment, const ImuSample& from, const ImuSample& to,
             const ImuBias& bias);

/// Increment over all samples, of which there is at least one.
MotionIncrement Integrate(std::span<const ImuSample> samples, const ImuBias& bias);

/// State at the end of an increment that starts in `state`.
MotionState Propagate(const MotionState& state, const MotionIncrement& increment);
/// State at the start of an increment that ends in `state`.
MotionState PropagateBack(const MotionState& state, const MotionIncrement& increment);

/// IMU samples between two instants condensed into one increment with its
/// covariance and its derivatives by the biases.
/// C. Forster et al., "On-Manifold Preintegration for Real-Time Visual-Inertial
/// Odometry", TRO 2017, section VI, with a higher-order integrator.
class ImuPreintegration {
 public:
  using Matrix9d = Eigen::Matrix<double, 9, 9>;

  /// `samples` start and end exactly at the two instants; at least two. Where they are noisier than
  /// `calibration` has it, so is the increment.
  ImuPreintegration(std::vector<ImuSample> samples, const ImuBias& bias,
                    const ImuCalibration& calibration);

  /// Integrates again at another bias, where first order no longer suffices.
  void Reintegrate(const ImuBias& bias);

  /// The increment at `bias`, to first order around bias().
  MotionIncrement Corrected(const ImuBias& bias) const;

  double duration() const { return increment_.duration; }
  Timestamp begin() const { return samples_.front().time; }
  Timestamp end() const { return samples_.back().time; }
  const std::vector<ImuSample>& samples() const { return samples_; }
  const ImuBias& bias() const { return bias_; }
  const MotionIncrement& increment() const { return increment_; }
  /// The covariance of [rotation vector, velocity, position].
  const Matrix9d& covariance() const { return covariance_; }
  /// Rows [rotation vector, velocity, position], columns gyroscope bias.
  const Eigen::Matrix<double, 9, 3>& d_gyroscope() const { return d_gyroscope_; }
  /// Rows [rotation vector, velocity, position], columns accelerometer bias.
  const Eigen::Matrix<double, 9, 3>& d_accelerometer() const { return d_accelerometer_; }
  const ImuCalibration& calibration() const { return calibration_; }

 private:
  void Step(const ImuSample& from, const ImuSample& to);

  std::vector<ImuSample> samples_;
  ImuBias bias_;
  ImuCalibration calibration_;
  MotionIncrement increment_;
  Matrix9d covariance_ = Matrix9d::Zero();
  Eigen::Matrix<double, 9, 3> d_gyroscope_ = Eigen::Matrix<double, 9, 3>::Zero();
  Eigen::Matrix<double, 9, 3> d_accelerometer_ = Eigen::Matrix<double, 9, 3>::Zero();
};

}  // namespace parkade
