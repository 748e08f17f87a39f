#include "slam/sessions/session_loop_cost.h"

namespace parkade {
namespace {

using DynamicJacobian = Eigen::Map<Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>>;

/// Derivatives by frame and bends, from those by the tangent of the pose, [rotation in the pose |
/// translation].
void FillJacobians(const PerturbedPose& pose, const double* frame, const double* bends,
                   const Matrix6d& by_tangent, double* by_frame, double* by_bends) {
  const Eigen::Matrix3d turn = FrameFromParameters(frame).rotation.toRotationMatrix();
  const Rigid3 in_site = pose.InSite(frame, bends);
  const Eigen::Matrix3d into_pose = in_site.rotation.conjugate().toRotationMatrix();
  if (by_frame) {
    const Eigen::Vector3d from_origin =
        in_site.translation - Eigen::Map<const Eigen::Vector3d>(frame + 1);
    Vector6d by_yaw;
    by_yaw << into_pose.col(2), Eigen::Vector3d::UnitZ().cross(from_origin);
    DynamicJacobian jacobian(by_frame, 6, kFrameSize);
    jacobian.col(0).noalias() = by_tangent * by_yaw;
    jacobian.rightCols<3>() = by_tangent.rightCols<3>();
  }
  if (by_bends) {
    DynamicJacobian jacobian(by_bends, 6, pose.modes.cols());
    jacobian.noalias() = by_tangent.leftCols<3>() * (into_pose * turn) * pose.modes.topRows<3>();
    jacobian.noalias() += by_tangent.rightCols<3>() * turn * pose.modes.bottomRows<3>();
  }
}

}  // namespace

Rigid3 FrameFromParameters(const double* frame) {
  return {ExpSo3({0, 0, frame[0]}), Eigen::Vector3d(frame[1], frame[2], frame[3])};
}

Rigid3 PerturbedPose::InSite(const double* frame, const double* bends) const {
  return FrameFromParameters(frame) *
         Bent(odom_from_pose, modes * Eigen::Map<const Eigen::VectorXd>(bends, modes.cols()));
}

SessionLoopCost::SessionLoopCost(PerturbedPose from, PerturbedPose to, const Rigid3& from_from_to,
                                 const Matrix6d& square_root_weight)
    : from_(std::move(from)), to_(std::move(to)), cost_(from_from_to, square_root_weight) {
  set_num_residuals(6);
  *mutable_parameter_block_sizes() = {kFrameSize, static_cast<int>(from_.modes.cols()), kFrameSize,
                                      static_cast<int>(to_.modes.cols())};
}

bool SessionLoopCost::Evaluate(double const* const* parameters, double* residual,
                               double** jacobians) const {
  std::array<double, kPoseSize> from{}, to{};
  PoseToParameters(from_.InSite(parameters[0], parameters[1]), from.data());
  PoseToParameters(to_.InSite(parameters[2], parameters[3]), to.data());
  const double* const poses[] = {from.data(), to.data()};
  if (!jacobians) return cost_.Evaluate(poses, residual, nullptr);
  using Jacobian = Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>;
  Jacobian by_from, by_to;
  double* by_pose[] = {by_from.data(), by_to.data()};
  if (!cost_.Evaluate(poses, residual, by_pose)) return false;
  FillJacobians(from_, parameters[0], parameters[1], by_from.leftCols<6>(), jacobians[0],
                jacobians[1]);
  FillJacobians(to_, parameters[2], parameters[3], by_to.leftCols<6>(), jacobians[2], jacobians[3]);
  return true;
}

}  // namespace parkade
