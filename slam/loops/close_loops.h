#pragma once

#include <vector>

#include "core/drive_log.h"
#include "slam/loops/loop_closure.h"
#include "slam/places/keyframe_store.h"

namespace parkade {

/// Finds places that the drive visits again, measures how they lie to each other, and bends the
/// odometry so that they do: keyframes' images are read again from `log`, DescribeKeyframes,
/// RecognizePlaces, EstimateRigPose (or a baseline), OptimizePoseGraphRobustly with gravity held.
/// `odometry` is odom_from_body of that log. Images are worked on in parallel; results do not
/// depend on the number of threads. `review` overrules; a loop it names that no two keyframes have
/// throws Error{kUsage}. `described` gets the keyframes that had to be described.
LoopClosure CloseLoops(const DriveLog& log, const Trajectory& odometry, const LoopOptions& options,
                       const LoopReview& review, KeyframeStore& described);

/// The poses of `odometry` carried along with its keyframes: between two of them, what odometry
/// says from either side is blended. `keyframes` and `corrected` correspond, keyframes in order of
/// time.
Trajectory CarryAlong(const Trajectory& odometry, const std::vector<RigKeyframe>& keyframes,
                      const std::vector<Rigid3>& odom_from_corrected);

}  // namespace parkade
