#pragma once

#include <ceres/manifold.h>

#include <Eigen/Core>

#include "slam/factors/imu_preintegration.h"
#include "slam/factors/motion_state.h"

namespace parkade {

// A state node is two parameter blocks:
//   pose    7: [qx qy qz qw | px py pz]  odom_from_imu; tangent 6: [rotation | translation]
//   motion  9: [v | b_g | b_a]           velocity in odom, biases
// The tangent of a pose is R <- R Exp(rotation), p <- p + translation.

inline constexpr int kPoseSize = 7;
inline constexpr int kPoseTangentSize = 6;
inline constexpr int kMotionSize = 9;

using MatrixPose = Eigen::Matrix<double, Eigen::Dynamic, kPoseSize, Eigen::RowMajor>;

inline Rigid3 PoseFromParameters(const double* pose) {
  return {Eigen::Quaterniond(pose[3], pose[0], pose[1], pose[2]),
          Eigen::Vector3d(pose[4], pose[5], pose[6])};
}

inline void PoseToParameters(const Rigid3& odom_from_imu, double* pose) {
  Eigen::Map<Eigen::Vector4d> rotation(pose);
  Eigen::Map<Eigen::Vector3d> translation(pose + 4);
  rotation = odom_from_imu.rotation.coeffs();
  translation = odom_from_imu.translation;
}

inline ImuBias BiasFromParameters(const double* motion) {
  return {Eigen::Vector3d(motion[3], motion[4], motion[5]),
          Eigen::Vector3d(motion[6], motion[7], motion[8])};
}

inline MotionState StateFromParameters(Timestamp time, const double* pose, const double* motion) {
  const ImuBias bias = BiasFromParameters(motion);
  return {time, PoseFromParameters(pose), Eigen::Vector3d(motion[0], motion[1], motion[2]),
          bias.gyroscope, bias.accelerometer};
}

inline void StateToParameters(const MotionState& state, double* pose, double* motion) {
  PoseToParameters(state.odom_from_imu, pose);
  Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>>(motion) << state.velocity_in_odom,
      state.gyroscope_bias, state.accelerometer_bias;
}

/// The manifold of a pose block. Jacobians of our cost functions are by the
/// tangent, in the first six of the block's seven columns, the last being zero
/// ("identity lift"): Ceres multiplies by PlusJacobian = [I6; 0], which is then
/// exact and spares each residual a 7 x 6 product.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return kPoseTangentSize; }
  bool Plus(const double* pose, const double* delta, double* pose_plus_delta) const override;
  bool PlusJacobian(const double* pose, double* jacobian) const override;
  bool Minus(const double* pose_plus_delta, const double* pose, double* delta) const override;
  bool MinusJacobian(const double* pose, double* jacobian) const override;
};

}  // namespace parkade
