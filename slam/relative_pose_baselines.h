#pragma once

#include "core/rig.h"
#include "slam/relative_pose.h"

namespace parkade {

// The three ways of the seed paper to measure a loop, for comparison: each uses one camera of either place, the pair
// with the most matches.

/// Perspective-n-points of the rays of one camera of `b` to the points of one camera of `a`. Its information is the
/// same for all loops, as there.
RelativePose EstimatePnpPose(const Place& a, const Place& b, const std::vector<FeatureMatch>& matches,
                             const RelativePoseOptions& options);

/// Rotation and direction between two cameras by the five-point method (D. Nister, TPAMI 2004) in RANSAC.
struct TwoViewPose {
  Rigid3 first_from_second;                 ///< cameras' centres, axes of the places; translation is a unit vector
  Eigen::Vector3d first_in_a, second_in_b;  ///< [m] the cameras' centres
  int num_matches = 0, num_inliers = 0;
  std::string rejected;  ///< empty: good
};
TwoViewPose EstimateTwoViewPose(const Place& a, const Place& b, const std::vector<FeatureMatch>& matches,
                                const RelativePoseOptions& options);

/// The information of a scale-less factor, in the order and frame of RelativePoseError: I - t t^T on translation,
/// weighted with 1 / `translation_sigma`^2, and 1 / `rotation_sigma`^2 on rotation. Seed paper, eq. 2. Without
/// direction (rotation only) the translation block is zero.
Matrix6d ScaleLessInformation(const Rigid3& from_from_to, double rotation_sigma, double translation_sigma,
                              bool has_direction);

}  // namespace parkade
