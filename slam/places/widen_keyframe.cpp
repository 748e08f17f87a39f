#include "slam/places/widen_keyframe.h"

#include <algorithm>

namespace parkade {

RigKeyframe WidenKeyframe(const std::vector<RigKeyframe>& keyframes, size_t index, size_t reach) {
  RigKeyframe wide = keyframes[index];
  const size_t begin = index - std::min(index, reach),
               end = std::min(index + reach + 1, keyframes.size());
  for (size_t i = begin; i < end; ++i) {
    if (i == index || keyframes[i].descriptors.empty()) continue;
    const Rigid3 keyframe_from_neighbor =
        wide.odom_from_keyframe.Inverse() * keyframes[i].odom_from_keyframe;
    for (KeyframeFeature feature : keyframes[i].features) {
      feature.origin = keyframe_from_neighbor * feature.origin;
      feature.bearing = keyframe_from_neighbor.rotation * feature.bearing;
      feature.image_point = {-1, -1};
      if (feature.point) feature.point = keyframe_from_neighbor * *feature.point;
      wide.features.push_back(feature);
    }
    wide.descriptors.push_back(keyframes[i].descriptors);
  }
  return wide;
}

}  // namespace parkade
