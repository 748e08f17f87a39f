#pragma once

#include <Eigen/Core>

#include "core/rigid3.h"
#include "core/timestamp.h"

namespace parkade {

/// [m/s^2] in odom, whose z axis points up.
inline const Eigen::Vector3d kGravityInOdom(0, 0, -9.81);

/// What the odometry knows of one instant. The moving frame is the IMU's.
struct MotionState {
  Timestamp time;
  Rigid3 odom_from_imu;
  Eigen::Vector3d velocity_in_odom = Eigen::Vector3d::Zero();    ///< [m/s] of the IMU
  Eigen::Vector3d gyroscope_bias = Eigen::Vector3d::Zero();      ///< [rad/s]
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< [m/s^2]

  bool IsFinite() const {
    return odom_from_imu.rotation.coeffs().allFinite() && odom_from_imu.translation.allFinite() &&
           velocity_in_odom.allFinite() && gyroscope_bias.allFinite() &&
           accelerometer_bias.allFinite();
  }
};

/// How well the first state is known: standard deviations. Yaw and position
/// are the choice of the odom frame, hence exact.
struct StartUncertainty {
  double tilt = 0.05;               ///< [rad]
  double velocity = 0.2;            ///< [m/s]
  double gyroscope_bias = 0.02;     ///< [rad/s]
  double accelerometer_bias = 0.1;  ///< [m/s^2]
};

}  // namespace parkade
