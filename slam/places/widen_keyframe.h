#pragma once

#include <vector>

#include "slam/places/rig_keyframe.h"

namespace parkade {

/// The keyframe `index` with what `reach` keyframes before and after it saw, in its frame. A point
/// beside the road is seen from several sides, so that a visit from another lane or direction finds
/// it alike; features that several neighbors saw are in it more than once.
RigKeyframe WidenKeyframe(const std::vector<RigKeyframe>& keyframes, size_t index, size_t reach);

}  // namespace parkade
