#include "slam/factors/standstill_cost.h"

namespace parkade {

bool StandstillCost::Evaluate(double const* const* parameters, double* residuals,
                              double** jacobians) const {
  Eigen::Map<Eigen::Matrix<double, 9, 1>> residual(residuals);
  const Rigid3 i = PoseFromParameters(parameters[0]), j = PoseFromParameters(parameters[1]);
  const Eigen::Quaterniond i_from_j = i.rotation.conjugate() * j.rotation;
  const Eigen::Vector3d turned = LogSo3(i_from_j);
  residual.head<3>() = turned / noise_.rotation;
  residual.segment<3>(3) = (j.translation - i.translation) / noise_.position;
  residual.tail<3>() = Eigen::Map<const Eigen::Vector3d>(parameters[2]) / noise_.velocity;
  if (!jacobians) return true;

  const Eigen::Matrix3d d_log = InverseRightJacobianSo3(turned);
  if (jacobians[0]) {
    Eigen::Map<Eigen::Matrix<double, 9, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
    jacobian.setZero();
    jacobian.topLeftCorner<3, 3>() =
        -d_log * i_from_j.toRotationMatrix().transpose() / noise_.rotation;
    jacobian.block<3, 3>(3, 3) = -Eigen::Matrix3d::Identity() / noise_.position;
  }
  if (jacobians[1]) {
    Eigen::Map<Eigen::Matrix<double, 9, 7, Eigen::RowMajor>> jacobian(jacobians[1]);
    jacobian.setZero();
    jacobian.topLeftCorner<3, 3>() = d_log / noise_.rotation;
    jacobian.block<3, 3>(3, 3) = Eigen::Matrix3d::Identity() / noise_.position;
  }
  if (jacobians[2]) {
    Eigen::Map<Eigen::Matrix<double, 9, 9, Eigen::RowMajor>> jacobian(jacobians[2]);
    jacobian.setZero();
    jacobian.block<3, 3>(6, 0) = Eigen::Matrix3d::Identity() / noise_.velocity;
  }
  return true;
}

}  // namespace parkade
