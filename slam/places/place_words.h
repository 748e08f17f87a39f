#pragma once

#include <cstdint>
#include <vector>

#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Tells which keyframes have which words. Words are fixed groups of 16 bits of the descriptors,
/// four per feature, so that there is no vocabulary to train or to ship (locality-sensitive
/// hashing: P. Indyk, R. Motwani, STOC 1998); all cameras of a keyframe make one document, so that
/// the left camera finds what the right one saw.
class PlaceWords {
 public:
  static constexpr std::uint32_t kNumWords = std::uint32_t{4} << 16;

  PlaceWords() = default;
  explicit PlaceWords(const std::vector<RigKeyframe>& keyframes);

  /// The next keyframe, with its descriptors.
  void Add(const RigKeyframe& keyframe);

  /// The words of each keyframe, ascending, each once.
  const std::vector<std::vector<std::uint32_t>>& of_keyframes() const { return of_keyframes_; }

  template <typename Archive>
  friend void Serialize(Archive& archive, PlaceWords& words) {
    archive(words.of_keyframes_);
  }

 private:
  std::vector<std::vector<std::uint32_t>> of_keyframes_;
};

}  // namespace parkade
