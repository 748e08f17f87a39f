#include "slam/factors/wheel_cost.h"

#include <Eigen/Cholesky>

namespace parkade {

WheelCost::WheelCost(const WheelPreintegration& preintegration) : preintegration_(preintegration) {
  sqrt_information_ = preintegration.covariance.llt().matrixL().solve(Eigen::Matrix3d::Identity());
}

bool WheelCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const Eigen::Vector3d displacement =
      preintegration_.displacement +
      preintegration_.d_gyroscope_bias *
          (BiasFromParameters(parameters[1]).gyroscope - preintegration_.gyroscope_bias);
  const Eigen::Vector3d& lever = preintegration_.body_in_imu;
  const Rigid3 i = PoseFromParameters(parameters[0]), j = PoseFromParameters(parameters[2]);
  const Eigen::Vector3d moved = i.rotation.conjugate() * (j * lever - i * lever);
  Eigen::Map<Eigen::Vector3d>(residuals).noalias() =
      sqrt_information_ * (moved - (1 + parameters[3][0]) * displacement);
  if (!jacobians) return true;

  const Eigen::Matrix3d back = i.rotation.toRotationMatrix().transpose();
  if (jacobians[0]) {
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
    jacobian.leftCols<3>().noalias() =
        sqrt_information_ *
        Skew(back * (j * lever - i.translation));  // R_i l turns with R_i: it cancels
    jacobian.middleCols<3>(3).noalias() = -sqrt_information_ * back;
    jacobian.col(6).setZero();
  }
  if (jacobians[1]) {
    Eigen::Map<Eigen::Matrix<double, 3, 9, Eigen::RowMajor>> jacobian(jacobians[1]);
    jacobian.setZero();
    jacobian.middleCols<3>(3).noalias() =
        -(1 + parameters[3][0]) * sqrt_information_ * preintegration_.d_gyroscope_bias;
  }
  if (jacobians[2]) {
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> jacobian(jacobians[2]);
    jacobian.leftCols<3>().noalias() =
        -sqrt_information_ * back * j.rotation.toRotationMatrix() * Skew(lever);
    jacobian.middleCols<3>(3).noalias() = sqrt_information_ * back;
    jacobian.col(6).setZero();
  }
  if (jacobians[3])
    Eigen::Map<Eigen::Vector3d>(jacobians[3]).noalias() = -sqrt_information_ * displacement;
  return true;
}

}  // namespace parkade
