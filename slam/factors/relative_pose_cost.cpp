#include "slam/factors/relative_pose_cost.h"

namespace parkade {

bool RelativePoseCost::Evaluate(const double* const* parameters, double* residual,
                                double** jacobians) const {
  const Rigid3 world_from_from = PoseFromParameters(parameters[0]),
               world_from_to = PoseFromParameters(parameters[1]);
  const Rigid3 from_from_to = world_from_from.Inverse() * world_from_to;
  Eigen::Quaterniond turn = from_from_to_.rotation.conjugate() * from_from_to.rotation;
  if (turn.w() < 0) turn.coeffs() *= -1;
  const Eigen::Matrix3d measured_transposed = from_from_to_.rotation.toRotationMatrix().transpose();

  Vector6d error;
  error << measured_transposed * (from_from_to.translation - from_from_to_.translation),
      2 * turn.vec();
  Eigen::Map<Vector6d>(residual).noalias() = square_root_weight_ * error;
  if (!jacobians) return true;

  const Eigen::Matrix3d to_from_world =
      measured_transposed * world_from_from.rotation.toRotationMatrix().transpose();
  const Eigen::Matrix3d w = turn.w() * Eigen::Matrix3d::Identity(), v = Skew(turn.vec());
  using Jacobian = Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>;
  Matrix6d by_tangent;
  if (jacobians[0]) {
    by_tangent << measured_transposed * Skew(from_from_to.translation), -to_from_world,  //
        -(w - v) * measured_transposed, Eigen::Matrix3d::Zero();
    Eigen::Map<Jacobian> jacobian(jacobians[0]);
    jacobian.leftCols<6>().noalias() = square_root_weight_ * by_tangent;
    jacobian.col(6).setZero();
  }
  if (jacobians[1]) {
    by_tangent << Eigen::Matrix3d::Zero(), to_from_world, w + v, Eigen::Matrix3d::Zero();
    Eigen::Map<Jacobian> jacobian(jacobians[1]);
    jacobian.leftCols<6>().noalias() = square_root_weight_ * by_tangent;
    jacobian.col(6).setZero();
  }
  return true;
}

bool PlanarPoseManifold::Plus(const double* pose, const double* delta,
                              double* pose_plus_delta) const {
  const double whole[6] = {0, 0, delta[0], delta[1], delta[2], 0};
  return PoseManifold().Plus(pose, whole, pose_plus_delta);
}

bool PlanarPoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, kPoseSize, 3, Eigen::RowMajor>> matrix(jacobian);
  matrix.setZero();
  matrix(2, 0) = matrix(3, 1) = matrix(4, 2) = 1;
  return true;
}

bool PlanarPoseManifold::Minus(const double* pose_plus_delta, const double* pose,
                               double* delta) const {
  double whole[6];
  PoseManifold().Minus(pose_plus_delta, pose, whole);
  std::copy(whole + 2, whole + 5, delta);
  return true;
}

bool PlanarPoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor>> matrix(jacobian);
  matrix.setZero();
  matrix(0, 2) = matrix(1, 3) = matrix(2, 4) = 1;
  return true;
}

}  // namespace parkade
