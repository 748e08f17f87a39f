#pragma once

#include "slam/places/relative_pose.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Features of two keyframes that look alike and lie where `a_from_b` foretells: points of one seen
/// within a few sigma (of ray, point and pose) of a ray of the other. Among so few candidates the
/// ratio to the second best says more, so that several times as many matches survive as without a
/// pose. Each feature is matched at most once, the more alike first. Cost: features of `a` times
/// features of `b`.
std::vector<FeatureMatch> FindGuidedMatches(const RigKeyframe& a, const RigKeyframe& b,
                                            const Rigid3& a_from_b,
                                            const RelativePoseOptions& options);

}  // namespace parkade
