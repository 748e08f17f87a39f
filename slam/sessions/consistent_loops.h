#pragma once

#include <cstddef>
#include <vector>

#include "slam/places/rig_keyframe.h"
#include "slam/sessions/session_loop.h"

namespace parkade {

/// Which links agree with each other: the ways between their ends, by either drive's trajectory,
/// close with the links. A large set in which all agree with all (greedy), after J. Mangelson et
/// al., "Pairwise Consistent Measurement Set Maximization for Robust Multi-Robot Map Merging", ICRA
/// 2018. Indices, ascending.
std::vector<size_t> FindConsistentLoops(const std::vector<RigKeyframe>& keyframes_a,
                                        const std::vector<RigKeyframe>& keyframes_b,
                                        const std::vector<SessionLoop>& links,
                                        const SessionLoopOptions& options);

}  // namespace parkade
