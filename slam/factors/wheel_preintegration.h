#pragma once

#include <Eigen/Core>
#include <span>

#include "core/drive_log.h"
#include "slam/factors/imu_preintegration.h"

namespace parkade {

/// [s] without wheel samples that interpolation may bridge.
inline constexpr double kMaxWheelGap = 0.3;

/// How far wheel odometry can be trusted: standard deviations of the velocity
/// of the rear-axle center, over `correlation_time`.
struct WheelNoise {
  double forward_speed = 0.02;     ///< [m/s] along body x at rest
  double forward_fraction = 0.01;  ///< of the speed, added in quadrature: slip, gear play
  double lateral_speed = 0.03;  ///< [m/s] the axle does not move sideways: non-holonomic constraint
  double vertical_speed = 0.03;  ///< [m/s] nor upwards, but for springs
  double crosswise_fraction =
      0.01;                       ///< of the speed, added in quadrature to both: side slip, pitch
  double correlation_time = 0.1;  ///< [s] errors average out over longer times only
  void Validate() const;
};

/// Displacement of the body origin between two instants as gyroscope and wheels
/// tell it, in the IMU frame at the start ("gyro-odometer"). Independent of
/// ramps and uneven ground: only the forward axis of the car is used.
///   d = sum over steps of 1/2 [dR_k R_IB v_k + dR_k+1 R_IB v_k+1] dt,  v = (v_x, 0, 0)
/// which is METHOD eq. (3) for the body origin instead of the IMU.
struct WheelPreintegration {
  double duration = 0;                                         ///< [s]
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();      ///< [m] in imu at the start
  Eigen::Matrix3d d_gyroscope_bias = Eigen::Matrix3d::Zero();  ///< around `gyroscope_bias`
  Eigen::Vector3d gyroscope_bias = Eigen::Vector3d::Zero();    ///< [rad/s]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();        ///< [m^2] in imu at the start
  Eigen::Vector3d body_in_imu = Eigen::Vector3d::Zero();       ///< [m] body origin
};

/// Both sample lists start and end exactly at the two instants. `wheels` are
/// interpolated at the times of `imu`.
WheelPreintegration PreintegrateWheels(std::span<const ImuSample> imu,
                                       std::span<const WheelSample> wheels,
                                       const Eigen::Vector3d& gyroscope_bias,
                                       const Rigid3& imu_from_body, const WheelNoise& noise);

}  // namespace parkade
