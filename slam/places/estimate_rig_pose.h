#pragma once

#include <vector>

#include "slam/places/place.h"
#include "slam/places/relative_pose.h"

namespace parkade {

/// Best matches that are mutual and distinct.
std::vector<FeatureMatch> MatchPlaces(const Place& a, const Place& b, const RelativePoseOptions& options);

/// The rig's relative pose from rays of either place to points of the other, all cameras at once (a generalised
/// camera with metric points). Places are level, hence two matches fix a candidate: yaw and translation solve four
/// linear equations and one circle. Then all inliers of both directions are adjusted over six degrees of freedom,
/// whose Hessian is the information. Deterministic.
RelativePose EstimateRigPose(const Place& a, const Place& b, const std::vector<FeatureMatch>& matches,
                             const RelativePoseOptions& options);

}  // namespace parkade
