#pragma once

#include <vector>

#include "slam/loops/loop_closure.h"
#include "slam/places/keyframe_store.h"

namespace parkade {

/// Measures how the keyframes of candidates lie to each other, by the whole rig or a baseline
/// (`options.method`). In the candidates' order; in parallel. Of the keyframes with their features
/// only those of some dozens of candidates are in memory.
///
/// \param described  has the keyframes of all candidates
/// \param keyframes  of the drive; without features
/// \param views      gets what the cameras that share the most inliers saw
std::vector<LoopEvidence> MeasureLoops(const KeyframeStore& described,
                                       const std::vector<RigKeyframe>& keyframes,
                                       const std::vector<PlaceCandidate>& candidates,
                                       const LoopOptions& options, LoopViews& views);

}  // namespace parkade
