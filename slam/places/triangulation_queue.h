#pragma once

#include <functional>
#include <vector>

#include "slam/places/keyframe_options.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

using KeyframeSink = std::function<void(RigKeyframe&& keyframe)>;

/// Keyframes of a drive in their order, whose features get points as soon as the neighbors' are
/// there (TriangulateFeatures). Only some dozens are in memory with their features.
class TriangulationQueue {
 public:
  /// `keyframes` are all of the drive, without features. `options` is borrowed; `sink` gets all
  /// keyframes in their order.
  TriangulationQueue(std::vector<RigKeyframe> keyframes, const KeyframeOptions& options,
                     KeyframeSink sink);

  const std::vector<RigKeyframe>& keyframes() const { return keyframes_; }
  /// A keyframe that is not complete yet.
  RigKeyframe& At(size_t index) { return keyframes_[index]; }
  /// Keyframes before `end` change no more.
  void Complete(size_t end);

 private:
  std::vector<RigKeyframe> keyframes_;
  const KeyframeOptions& options_;
  KeyframeSink sink_;
  size_t num_done_ = 0, num_forgotten_ = 0;
};

}  // namespace parkade
