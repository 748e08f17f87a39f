#include "slam/factors/bearing_cost.h"

#include "slam/factors/measurement_model.h"

namespace parkade {
namespace {

// A landmark this near to the camera [inverse-distance units] has no direction.
constexpr double kMinNorm = 1e-9;

/// A landmark on its way into the camera; each step but the last is a vector
/// times inverse distance.
struct Look {
  Eigen::Vector3d velocity;   // w R(t0)^T v: of the imu, in imu at the image's time t0
  Eigen::Vector3d before;     // R(t0)^T (ray + w (origin - p(t))), not turned on yet
  Eigen::Vector3d in_imu;     // at t
  Eigen::Vector3d in_camera;  // d
};

/// Exp(-angle) v to second order: angles within an image are small.
Eigen::Vector3d TurnBack(const Eigen::Vector3d& angle, const Eigen::Vector3d& v) {
  const Eigen::Vector3d turned = angle.cross(v);
  return v - turned + 0.5 * angle.cross(turned);
}

Look LookAt(const ImageView& view, const LandmarkRay& ray, const double* landmark, double delay) {
  const double w = landmark[2];
  Look look;
  look.velocity = w * (view.pose.odom_from_imu.transpose() * view.velocity_in_odom);
  look.before = view.pose.odom_from_imu.transpose() *
                    (ray.Ray(landmark) + w * (ray.origin - view.pose.imu_in_odom)) -
                delay * look.velocity;
  look.in_imu = TurnBack(delay * view.angular_velocity, look.before);
  look.in_camera = view.camera_from_imu * (look.in_imu - w * view.camera_in_imu);
  return look;
}

}  // namespace

std::vector<double*> ImageView::Blocks() const {
  if (!second_pose) return {first_pose, extrinsics, timing};
  return {first_pose, second_pose, extrinsics, timing};
}

void ImageView::Update() {
  const double* second = second_pose ? second_pose : first_pose;
  pose =
      EvaluateImagePose(interpolation, PoseFromParameters(first_pose), PoseFromParameters(second));
  const Rigid3 imu_from_camera = PoseFromParameters(extrinsics);
  camera_from_imu = imu_from_camera.rotation.toRotationMatrix().transpose();
  camera_in_imu = imu_from_camera.translation;
}

Rigid3 ImageView::OdomFromCamera(double row) const {
  const double delay = Delay(row);
  const Eigen::Quaterniond rotation(pose.odom_from_imu);
  return Rigid3{rotation * ExpSo3(delay * angular_velocity),
                pose.imu_in_odom + delay * velocity_in_odom} *
         PoseFromParameters(extrinsics);
}

Eigen::Vector3d LandmarkInCamera(const ImageView& view, const LandmarkRay& ray,
                                 const double* landmark, double row) {
  return LookAt(view, ray, landmark, view.Delay(row)).in_camera;
}

bool IsOutlier(const ImageView& view, const LandmarkRay& ray, const double* landmark,
               const Bearing& bearing) {
  const Eigen::Vector3d direction = LandmarkInCamera(view, ray, landmark, bearing.row);
  const Eigen::Vector2d error = bearing.basis.transpose() * direction.normalized() / bearing.sigma;
  return !(direction.dot(bearing.direction) > 0 &&
           error.squaredNorm() < kMaxBearingError * kMaxBearingError);
}

/// Derivatives of the residual by what the landmark passes through.
struct BearingCost::Derivatives {
  Look look;
  double w = 0;                        // inverse distance
  Eigen::Matrix<double, 2, 3> camera;  // by a vector in the camera
  Eigen::Matrix<double, 2, 3> imu;     // by one in imu at t
  Eigen::Matrix<double, 2, 3> before;  // by one in imu at t0
  Eigen::Matrix<double, 2, 3> odom;    // by one in odom
};

BearingCost::BearingCost(const ImageView* view, const LandmarkRay* ray, const Bearing& bearing)
    : view_(view), ray_(ray), bearing_(bearing) {
  set_num_residuals(2);
  mutable_parameter_block_sizes()->push_back(kPoseSize);
  if (view->second_pose) mutable_parameter_block_sizes()->push_back(kPoseSize);
  mutable_parameter_block_sizes()->insert(mutable_parameter_block_sizes()->end(),
                                          {kPoseSize, kTimingSize, kLandmarkSize});
}

using PoseJacobian = Eigen::Map<Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>>;

void BearingCost::FillPoses(const Derivatives& by, double** jacobians) const {
  const ImagePose& pose = view_->pose;
  const bool is_between = view_->second_pose != nullptr;
  if (!jacobians[0] && !(is_between && jacobians[1])) return;
  const Eigen::Matrix<double, 2, 3> by_rotation = by.before * Skew(by.look.before);
  const Eigen::Matrix<double, 2, 3> by_position = -by.w * by.odom;
  if (jacobians[0]) {
    PoseJacobian jacobian(jacobians[0]);
    jacobian.leftCols<3>().noalias() =
        by_rotation * pose.rotation_by_first + by_position * pose.position_by_first_rotation;
    jacobian.middleCols<3>(3) = (1 - pose.fraction) * by_position;
    jacobian.col(6).setZero();
  }
  if (is_between && jacobians[1]) {
    PoseJacobian jacobian(jacobians[1]);
    jacobian.leftCols<3>().noalias() = by_rotation * pose.rotation_by_second;
    jacobian.middleCols<3>(3) = pose.fraction * by_position;
    jacobian.col(6).setZero();
  }
}

void BearingCost::FillCamera(const Derivatives& by, double** jacobians) const {
  if (jacobians[0]) {
    PoseJacobian jacobian(jacobians[0]);
    jacobian.leftCols<3>().noalias() = by.camera * Skew(by.look.in_camera);
    jacobian.middleCols<3>(3) = -by.w * by.imu;
    jacobian.col(6).setZero();
  }
  if (jacobians[1]) {
    Eigen::Map<Eigen::Matrix<double, 2, kTimingSize, Eigen::RowMajor>> jacobian(jacobians[1]);
    const Eigen::Vector3d turning = view_->angular_velocity.cross(by.look.before);
    const Eigen::Vector3d rate =
        turning - view_->Delay(bearing_.row) * view_->angular_velocity.cross(turning);
    jacobian.col(0) = -by.imu * rate - by.before * by.look.velocity;
    jacobian.col(1) = bearing_.row * jacobian.col(0);
    if (view_->holds_time_offset) jacobian.col(0).setZero();
    if (view_->holds_line_delay) jacobian.col(1).setZero();
  }
}

bool BearingCost::Evaluate(double const* const* parameters, double* residuals,
                           double** jacobians) const {
  const int camera_block = view_->second_pose ? 2 : 1;
  const double* landmark = parameters[camera_block + 2];
  const double delay = view_->Delay(bearing_.row);
  const Eigen::Matrix<double, 2, 3> across = bearing_.basis.transpose() / bearing_.sigma;
  Derivatives by;
  by.look = LookAt(*view_, *ray_, landmark, delay);
  const double norm = by.look.in_camera.norm();
  if (!(norm > kMinNorm)) return false;
  Eigen::Map<Eigen::Vector2d>(residuals).noalias() = across * (by.look.in_camera / norm);
  if (!jacobians) return true;

  const ImagePose& pose = view_->pose;
  const Eigen::Vector3d unit = by.look.in_camera / norm;
  const Eigen::Vector3d angle = delay * view_->angular_velocity;
  by.w = landmark[2];
  by.camera = (across - (across * unit) * unit.transpose()) / norm;
  by.imu = by.camera * view_->camera_from_imu;
  for (int i = 0; i < 2; ++i)
    by.before.row(i) = TurnBack(-angle, by.imu.row(i).transpose()).transpose();
  by.odom = by.before * pose.odom_from_imu.transpose();

  FillPoses(by, jacobians);
  FillCamera(by, jacobians + camera_block);
  if (jacobians[camera_block + 2]) {
    Eigen::Map<Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor>> jacobian(
        jacobians[camera_block + 2]);
    jacobian.leftCols<2>().noalias() = by.odom * ray_->basis;
    jacobian.col(2) =
        by.odom * (ray_->origin - pose.imu_in_odom - delay * view_->velocity_in_odom) -
        by.imu * view_->camera_in_imu;
  }
  return true;
}

}  // namespace parkade
