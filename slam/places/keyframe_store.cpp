#include "slam/places/keyframe_store.h"

#include "slam/places/keyframe_bytes.h"

namespace parkade {

void KeyframeStore::Add(const RigKeyframe& keyframe) {
  const std::string bytes = EncodeKeyframes({keyframe});
  places_[keyframe.time] = {file_.size(), bytes.size()};
  file_.Append(bytes);
}

std::optional<RigKeyframe> KeyframeStore::Find(Timestamp time) const {
  const auto found = places_.find(time);
  if (found == places_.end()) return std::nullopt;
  const Place& place = found->second;
  return std::move(DecodeKeyframes(file_.Read(place.offset, place.size)).front());
}

}  // namespace parkade
