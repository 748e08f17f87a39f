#include "slam/bearing_cost.h"

namespace parkade {
namespace {

// A landmark this near to the camera [inverse-distance units] has no direction.
constexpr double kMinNorm = 1e-9;

struct InImu {
  Eigen::Vector3d offset;     // R(t)^T (ray + w (origin - p))
  Eigen::Vector3d in_camera;  // d
};

InImu TransformLandmark(const ImageView& view, const ImagePose& pose, const LandmarkRay& ray, const double* landmark) {
  const double w = landmark[2];
  InImu result;
  result.offset = pose.odom_from_imu.transpose() * (ray.Ray(landmark) + w * (ray.origin - pose.imu_in_odom));
  result.in_camera = view.imu_from_camera.rotation.conjugate() * (result.offset - w * view.imu_from_camera.translation);
  return result;
}

}  // namespace

void ImageView::Update() {
  const double* second = second_pose ? second_pose : first_pose;
  current = EvaluateImagePose(interpolation, PoseFromParameters(first_pose), PoseFromParameters(second));
  is_at_first_estimate = (first_estimate && first_estimate->is_fixed) || (second_estimate && second_estimate->is_fixed);
  if (!is_at_first_estimate) return;
  const double* first_at = first_estimate ? first_estimate->Pose(first_pose) : first_pose;
  const double* second_at = !second_pose      ? first_at
                            : second_estimate ? second_estimate->Pose(second_pose)
                                              : second_pose;
  linearised = EvaluateImagePose(interpolation, PoseFromParameters(first_at), PoseFromParameters(second_at));
}

Eigen::Vector3d LandmarkInCamera(const ImageView& view, const LandmarkRay& ray, const double* landmark) {
  return TransformLandmark(view, view.current, ray, landmark).in_camera;
}

BearingCost::BearingCost(const ImageView* view, const LandmarkRay* ray, const Bearing& bearing)
    : view_(view), ray_(ray), bearing_(bearing) {
  set_num_residuals(2);
  mutable_parameter_block_sizes()->push_back(kPoseSize);
  if (view->second_pose) mutable_parameter_block_sizes()->push_back(kPoseSize);
  mutable_parameter_block_sizes()->push_back(kLandmarkSize);
}

bool BearingCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const int landmark_block = view_->second_pose ? 2 : 1;
  const double* landmark = parameters[landmark_block];
  const Eigen::Matrix<double, 2, 3> across = bearing_.basis.transpose() / bearing_.sigma;
  InImu at = TransformLandmark(*view_, view_->current, *ray_, landmark);
  double norm = at.in_camera.norm();
  if (!(norm > kMinNorm)) return false;
  Eigen::Map<Eigen::Vector2d>(residuals).noalias() = across * (at.in_camera / norm);
  if (!jacobians) return true;

  const ImagePose& pose = view_->is_at_first_estimate ? view_->linearised : view_->current;
  if (view_->is_at_first_estimate) {
    at = TransformLandmark(*view_, pose, *ray_, landmark);
    norm = at.in_camera.norm();
    if (!(norm > kMinNorm)) return false;
  }
  const Eigen::Vector3d unit = at.in_camera / norm;
  const Eigen::Matrix<double, 2, 3> by_direction = (across - (across * unit) * unit.transpose()) / norm;
  const Eigen::Matrix<double, 2, 3> by_imu =
      by_direction * view_->imu_from_camera.rotation.toRotationMatrix().transpose();
  const Eigen::Matrix<double, 2, 3> by_odom = by_imu * pose.odom_from_imu.transpose();
  const Eigen::Matrix<double, 2, 3> by_rotation = by_imu * Skew(at.offset);
  const Eigen::Matrix<double, 2, 3> by_position = -landmark[2] * by_odom;

  using PoseJacobian = Eigen::Map<Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>>;
  if (jacobians[0]) {
    PoseJacobian jacobian(jacobians[0]);
    jacobian.leftCols<3>().noalias() =
        by_rotation * pose.rotation_by_first + by_position * pose.position_by_first_rotation;
    jacobian.middleCols<3>(3) = (1 - pose.fraction) * by_position;
    jacobian.col(6).setZero();
  }
  if (view_->second_pose && jacobians[1]) {
    PoseJacobian jacobian(jacobians[1]);
    jacobian.leftCols<3>().noalias() = by_rotation * pose.rotation_by_second;
    jacobian.middleCols<3>(3) = pose.fraction * by_position;
    jacobian.col(6).setZero();
  }
  if (jacobians[landmark_block]) {
    Eigen::Map<Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor>> jacobian(jacobians[landmark_block]);
    jacobian.leftCols<2>().noalias() = by_odom * ray_->basis;
    jacobian.col(2) = by_odom * (ray_->origin - pose.imu_in_odom) -
                      by_direction * (view_->imu_from_camera.rotation.conjugate() * view_->imu_from_camera.translation);
  }
  return true;
}

}  // namespace parkade
