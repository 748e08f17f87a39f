#pragma once

#include <cstddef>
#include <vector>

#include "slam/places/keyframe_options.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Keyframes before and after one that see the same corners.
inline constexpr size_t kNeighborKeyframes = 2;

/// The features of keyframe `index` with points from matching features of the same camera at its
/// neighbors.
std::vector<KeyframeFeature> TriangulateFeatures(const std::vector<RigKeyframe>& keyframes,
                                                 size_t index, const KeyframeOptions& options);

}  // namespace parkade
