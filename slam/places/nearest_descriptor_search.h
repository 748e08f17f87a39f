#pragma once

#include <algorithm>
#include <optional>

#include "slam/places/hamming.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Finds the one feature of a keyframe that looks like a descriptor, among those it is shown.
class NearestDescriptorSearch {
 public:
  /// `descriptor` of 32 bytes is borrowed.
  explicit NearestDescriptorSearch(const uchar* descriptor) : descriptor_(descriptor) {}

  void Look(const RigKeyframe& keyframe, size_t index) {
    const int hamming =
        HammingDistance(descriptor_, keyframe.descriptors.ptr(static_cast<int>(index)));
    if (hamming < best_) {
      second_ = best_;
      best_ = hamming;
      index_ = index;
    } else {
      second_ = std::min(second_, hamming);
    }
  }

  /// The index of the nearest feature. Nothing when it is further than `max_hamming` [bits], or two
  /// are alike: further than `ratio` times the second best.
  std::optional<size_t> Found(int max_hamming, double ratio) const {
    return best_ <= max_hamming && best_ <= ratio * second_ ? std::optional(index_) : std::nullopt;
  }

  int hamming() const { return best_; }

 private:
  static constexpr int kBits = 8 * kDescriptorBytes;

  const uchar* descriptor_;
  int best_ = kBits, second_ = kBits;
  size_t index_ = 0;
};

}  // namespace parkade
