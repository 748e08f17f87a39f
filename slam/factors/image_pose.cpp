#include "slam/factors/image_pose.h"

namespace parkade {

Rigid3 NodeInterpolation::At(const Rigid3& first, const Rigid3& second) const {
  const Eigen::Vector3d error =
      LogSo3(rotation_over_interval.conjugate() * (first.rotation.conjugate() * second.rotation));
  return {
      (first.rotation * rotation_since_first * ExpSo3(fraction * error)).normalized(),
      (1 - fraction) * first.translation + fraction * second.translation + first.rotation * bend};
}

NodeInterpolation MakeNodeInterpolation(const MotionIncrement& part, const MotionIncrement& whole,
                                        const Eigen::Quaterniond& odom_from_first) {
  NodeInterpolation interpolation;
  interpolation.fraction = part.duration / whole.duration;
  interpolation.rotation_since_first = part.rotation;
  interpolation.rotation_over_interval = whole.rotation;
  interpolation.bend =
      odom_from_first.conjugate() *
          (0.5 * part.duration * (part.duration - whole.duration) * kGravityInOdom) +
      part.position - interpolation.fraction * whole.position;
  return interpolation;
}

ImagePose EvaluateImagePose(const NodeInterpolation& interpolation, const Rigid3& first,
                            const Rigid3& second) {
  const double f = interpolation.fraction;
  const Eigen::Quaterniond first_from_second = first.rotation.conjugate() * second.rotation;
  const Eigen::Vector3d error =
      LogSo3(interpolation.rotation_over_interval.conjugate() * first_from_second);
  const Eigen::Quaterniond share = ExpSo3(f * error);
  const Eigen::Matrix3d d_share = f * RightJacobianSo3(f * error) * InverseRightJacobianSo3(error);
  const Eigen::Matrix3d first_rotation = first.rotation.toRotationMatrix();

  ImagePose pose;
  pose.odom_from_imu =
      (first.rotation * interpolation.rotation_since_first * share).toRotationMatrix();
  pose.imu_in_odom =
      (1 - f) * first.translation + f * second.translation + first_rotation * interpolation.bend;
  pose.rotation_by_first =
      (interpolation.rotation_since_first * share).toRotationMatrix().transpose() -
      d_share * first_from_second.toRotationMatrix().transpose();
  pose.rotation_by_second = d_share;
  pose.position_by_first_rotation = -first_rotation * Skew(interpolation.bend);
  pose.fraction = f;
  return pose;
}

}  // namespace parkade
