#pragma once

#include <vector>

#include "slam/loops/loop_closure.h"
#include "slam/places/keyframe_store.h"

namespace parkade {

/// Loops in the order of their candidates, and what the cameras that share the most inliers saw.
struct MeasuredLoops {
  std::vector<LoopEvidence> loops;
  LoopViews views;
};

/// Measures how the keyframes of candidates lie to each other, by the whole rig or a baseline
/// (`options.method`); in parallel. Of the keyframes with their features only those of some dozens
/// of candidates are in memory.
///
/// \param described  has the keyframes of all candidates: Error{kInternal} where it lacks one
/// \param keyframes  of the drive; without features
MeasuredLoops MeasureLoops(const KeyframeStore& described,
                           const std::vector<RigKeyframe>& keyframes,
                           const std::vector<PlaceCandidate>& candidates,
                           const LoopOptions& options);

}  // namespace parkade
