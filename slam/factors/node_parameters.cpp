#include "slam/factors/node_parameters.h"

namespace parkade {

bool PoseManifold::Plus(const double* pose, const double* delta, double* pose_plus_delta) const {
  const Rigid3 from = PoseFromParameters(pose);
  const Eigen::Map<const Eigen::Vector3d> turn(delta), shift(delta + 3);
  PoseToParameters({(from.rotation * ExpSo3(turn)).normalized(), from.translation + shift},
                   pose_plus_delta);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, kPoseSize, kPoseTangentSize, Eigen::RowMajor>>(jacobian)
      .setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* pose_plus_delta, const double* pose, double* delta) const {
  const Rigid3 to = PoseFromParameters(pose_plus_delta), from = PoseFromParameters(pose);
  Eigen::Map<Eigen::Vector3d>(delta).noalias() = LogSo3(from.rotation.conjugate() * to.rotation);
  Eigen::Map<Eigen::Vector3d>(delta + 3) = to.translation - from.translation;
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, kPoseTangentSize, kPoseSize, Eigen::RowMajor>>(jacobian)
      .setIdentity();
  return true;
}

}  // namespace parkade
