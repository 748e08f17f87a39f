#pragma once

#include "core/rig.h"
#include "slam/places/relative_pose.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

// Three ways to measure a loop that are known from papers, for comparison: each uses one camera of
// either keyframe, the pair with the most matches.

/// Perspective-n-points of the rays of one camera of `b` to the points of one camera of `a`, in
/// RANSAC, then adjusted to its inliers, which say how well it is known
/// (CovarianceOfCorrespondences).
RelativePose EstimatePnpPose(const RigKeyframe& a, const RigKeyframe& b,
                             const std::vector<FeatureMatch>& matches,
                             const RelativePoseOptions& options);

/// Rotation and direction between two cameras by the five-point method (D. Nister, TPAMI 2004) in
/// RANSAC, then adjusted to its inliers (AdjustTwoViews).
struct TwoViewPose {
  Rigid3
      first_from_second;  ///< cameras' centers, axes of the keyframes; translation is a unit vector
  Eigen::Vector3d first_in_a, second_in_b;  ///< [m] the cameras' centers
  Eigen::Matrix3d rotation_covariance =
      Eigen::Matrix3d::Identity();  ///< [rad^2] on the right of the rotation
  double direction_sigma = 1;       ///< [rad]
  int num_matches = 0, num_inliers = 0;
  std::string rejected;  ///< empty: good
};
TwoViewPose EstimateTwoViewPose(const RigKeyframe& a, const RigKeyframe& b,
                                const std::vector<FeatureMatch>& matches,
                                const RelativePoseOptions& options);

/// The information of a scale-less factor, in the order and frame of RelativePoseError: I - t t^T
/// on translation, weighted with 1 / `translation_sigma`^2, and the inverse of
/// `rotation_covariance` on rotation. Seed paper, eq. 2. Without direction (rotation only) the
/// translation block is zero.
Matrix6d ScaleLessInformation(const Rigid3& from_from_to,
                              const Eigen::Matrix3d& rotation_covariance, double translation_sigma,
                              bool has_direction);

}  // namespace parkade
