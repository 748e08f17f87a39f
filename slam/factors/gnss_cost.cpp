#include "slam/factors/gnss_cost.h"

namespace parkade {

bool GnssCost::Evaluate(double const* const* parameters, double* residuals,
                        double** jacobians) const {
  const double* const site = parameters[2];
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(site[0], Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d weight = fix_.sigma.cwiseInverse();
  const Rigid3 poses[] = {PoseFromParameters(parameters[0]), PoseFromParameters(parameters[1])};
  const double shares[] = {1 - fix_.fraction, fix_.fraction};
  Eigen::Vector3d antenna_in_odom = Eigen::Vector3d::Zero();
  for (int k = 0; k < 2; ++k) antenna_in_odom += shares[k] * (poses[k] * fix_.antenna_in_imu);
  const Eigen::Vector3d turned = turn * antenna_in_odom;
  Eigen::Map<Eigen::Vector3d>(residuals).array() =
      (turned + Eigen::Vector3d(site[1], site[2], site[3]) - fix_.antenna_in_site).array() *
      weight.array();
  if (!jacobians) return true;

  for (int k = 0; k < 2; ++k) {
    if (!jacobians[k]) continue;
    Eigen::Map<Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor>> jacobian(jacobians[k]);
    const Eigen::Matrix3d by_position = shares[k] * (weight.asDiagonal() * turn);
    jacobian.leftCols<3>() =
        -by_position * poses[k].rotation.toRotationMatrix() * Skew(fix_.antenna_in_imu);
    jacobian.middleCols<3>(3) = by_position;
    jacobian.col(6).setZero();
  }
  if (jacobians[2]) {
    Eigen::Map<Eigen::Matrix<double, 3, kSiteSize, Eigen::RowMajor>> jacobian(jacobians[2]);
    jacobian.col(0) = weight.cwiseProduct(Eigen::Vector3d(-turned.y(), turned.x(), 0));
    jacobian.rightCols<3>() = weight.asDiagonal();
  }
  return true;
}

}  // namespace parkade
