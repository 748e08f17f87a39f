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
  /// A word that a keyframe has.
  struct Entry {
    std::uint32_t word = 0;
    std::uint32_t keyframe = 0;  ///< index
    auto operator<=>(const Entry&) const = default;
  };

  explicit PlaceWords(const std::vector<RigKeyframe>& keyframes);

  size_t num_keyframes() const { return num_keyframes_; }
  const std::vector<Entry>& entries() const { return entries_; }  ///< sorted, each once

 private:
  size_t num_keyframes_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace parkade
