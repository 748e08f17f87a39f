#include "slam/factors/imu_cost.h"

#include <Eigen/Cholesky>

namespace parkade {
namespace {

// Relative to the diagonal: keeps the factorization alive where a sensor is
// declared (nearly) noise-free.
constexpr double kCovarianceFloor = 1e-12;

}  // namespace

ImuCost::ImuCost(const ImuPreintegration* preintegration) : preintegration_(preintegration) {
  Eigen::Matrix<double, 9, 9> covariance = preintegration->covariance();
  covariance.diagonal().array() += kCovarianceFloor;
  // S = L^-1 of covariance = L L^T.
  sqrt_information_ = covariance.llt().matrixL().solve(Eigen::Matrix<double, 9, 9>::Identity());
  const double root = std::sqrt(preintegration->duration());
  gyroscope_weight_ = 1 / (preintegration->calibration().gyroscope_random_walk * root);
  accelerometer_weight_ = 1 / (preintegration->calibration().accelerometer_random_walk * root);
}

ImuCost::Vector15d ImuCost::Residual(const MotionState& i, const MotionState& j) const {
  const double t = preintegration_->duration();
  const MotionIncrement increment =
      preintegration_->Corrected({i.gyroscope_bias, i.accelerometer_bias});
  const Eigen::Quaterniond back = i.odom_from_imu.rotation.conjugate();
  Vector15d residual;
  residual.segment<3>(0) =
      LogSo3(increment.rotation.conjugate() * (back * j.odom_from_imu.rotation));
  residual.segment<3>(3) =
      back * (j.velocity_in_odom - i.velocity_in_odom - t * kGravityInOdom) - increment.velocity;
  residual.segment<3>(6) = back * (j.odom_from_imu.translation - i.odom_from_imu.translation -
                                   t * i.velocity_in_odom - 0.5 * t * t * kGravityInOdom) -
                           increment.position;
  residual.head<9>() = sqrt_information_ * residual.head<9>().eval();
  residual.segment<3>(9) = gyroscope_weight_ * (j.gyroscope_bias - i.gyroscope_bias);
  residual.segment<3>(12) = accelerometer_weight_ * (j.accelerometer_bias - i.accelerometer_bias);
  return residual;
}

void ImuCost::FillJacobians(const MotionState& i, const MotionState& j, double** jacobians) const {
  const double t = preintegration_->duration();
  const Eigen::Matrix3d back = i.odom_from_imu.rotation.toRotationMatrix().transpose();
  const Eigen::Matrix3d i_from_j = back * j.odom_from_imu.rotation.toRotationMatrix();
  const auto& by_gyroscope = preintegration_->d_gyroscope();
  const auto& by_accelerometer = preintegration_->d_accelerometer();
  const MotionIncrement increment =
      preintegration_->Corrected({i.gyroscope_bias, i.accelerometer_bias});
  const Eigen::Vector3d error =
      LogSo3(increment.rotation.conjugate() * i.odom_from_imu.rotation.conjugate() *
             j.odom_from_imu.rotation);
  const Eigen::Matrix3d d_log = InverseRightJacobianSo3(error);
  const Eigen::Vector3d change =
      by_gyroscope.topRows<3>() * (i.gyroscope_bias - preintegration_->bias().gyroscope);

  Eigen::Matrix<double, 9, 6> pose_i = Eigen::Matrix<double, 9, 6>::Zero();
  pose_i.block<3, 3>(0, 0) = -d_log * i_from_j.transpose();
  pose_i.block<3, 3>(3, 0) =
      Skew(back * (j.velocity_in_odom - i.velocity_in_odom - t * kGravityInOdom));
  pose_i.block<3, 3>(6, 0) =
      Skew(back * (j.odom_from_imu.translation - i.odom_from_imu.translation -
                   t * i.velocity_in_odom - 0.5 * t * t * kGravityInOdom));
  pose_i.block<3, 3>(6, 3) = -back;
  Eigen::Matrix<double, 9, 9> motion_i = Eigen::Matrix<double, 9, 9>::Zero();
  motion_i.block<3, 3>(3, 0) = -back;
  motion_i.block<3, 3>(6, 0) = -t * back;
  motion_i.middleCols<3>(3) = -by_gyroscope;
  motion_i.block<3, 3>(0, 3) = -d_log * ExpSo3(error).toRotationMatrix().transpose() *
                               RightJacobianSo3(change) * by_gyroscope.topRows<3>();
  motion_i.rightCols<3>() = -by_accelerometer;
  Eigen::Matrix<double, 9, 6> pose_j = Eigen::Matrix<double, 9, 6>::Zero();
  pose_j.block<3, 3>(0, 0) = d_log;
  pose_j.block<3, 3>(6, 3) = back;

  if (jacobians[0]) {
    Eigen::Map<Eigen::Matrix<double, 15, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
    jacobian.setZero();
    jacobian.topLeftCorner<9, 6>().noalias() = sqrt_information_ * pose_i;
  }
  if (jacobians[1]) {
    Eigen::Map<Eigen::Matrix<double, 15, 9, Eigen::RowMajor>> jacobian(jacobians[1]);
    jacobian.setZero();
    jacobian.topRows<9>().noalias() = sqrt_information_ * motion_i;
    jacobian.block<3, 3>(9, 3) = -gyroscope_weight_ * Eigen::Matrix3d::Identity();
    jacobian.block<3, 3>(12, 6) = -accelerometer_weight_ * Eigen::Matrix3d::Identity();
  }
  if (jacobians[2]) {
    Eigen::Map<Eigen::Matrix<double, 15, 7, Eigen::RowMajor>> jacobian(jacobians[2]);
    jacobian.setZero();
    jacobian.topLeftCorner<9, 6>().noalias() = sqrt_information_ * pose_j;
  }
  if (jacobians[3]) {
    Eigen::Map<Eigen::Matrix<double, 15, 9, Eigen::RowMajor>> jacobian(jacobians[3]);
    jacobian.setZero();
    jacobian.topLeftCorner<9, 3>().noalias() = sqrt_information_.middleCols<3>(3) * back;
    jacobian.block<3, 3>(9, 3) = gyroscope_weight_ * Eigen::Matrix3d::Identity();
    jacobian.block<3, 3>(12, 6) = accelerometer_weight_ * Eigen::Matrix3d::Identity();
  }
}

bool ImuCost::Evaluate(double const* const* parameters, double* residuals,
                       double** jacobians) const {
  const Timestamp none{};
  const MotionState i = StateFromParameters(none, parameters[0], parameters[1]);
  const MotionState j = StateFromParameters(none, parameters[2], parameters[3]);
  Eigen::Map<Vector15d>(residuals).noalias() = Residual(i, j);
  if (jacobians) FillJacobians(i, j, jacobians);
  return true;
}

}  // namespace parkade
