#pragma once

#include <vector>

#include "slam/places/relative_pose.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Matches of features that are each other's best and distinct.
std::vector<FeatureMatch> MatchKeyframes(const RigKeyframe& a, const RigKeyframe& b,
                                         const RelativePoseOptions& options);

/// The rig's relative pose from rays of either keyframe to points of the other, all cameras at once
/// (a generalized camera with metric points). Keyframes are level, hence two matches fix a
/// candidate: yaw and translation solve four linear equations and one circle. Then all inliers of
/// both directions are adjusted over six degrees of freedom, whose Hessian is the information.
/// Deterministic.
RelativePose EstimateRigPose(const RigKeyframe& a, const RigKeyframe& b,
                             const std::vector<FeatureMatch>& matches,
                             const RelativePoseOptions& options);

}  // namespace parkade
