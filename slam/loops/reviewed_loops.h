#pragma once

#include "slam/loops/loop_closure.h"

namespace parkade {

/// A review's decisions on the keyframes of one drive.
class ReviewedLoops {
 public:
  /// Throws Error{kUsage} for an id that is none of this drive.
  ReviewedLoops(const LoopReview& review, size_t num_keyframes);

  /// Forced loops' keyframes and their neighbors will be looked at.
  void MarkKeyframes(std::vector<bool>& is_wanted) const;
  /// Forced loops that recognition did not propose come last.
  void AddForced(std::vector<PlaceCandidate>& candidates) const;
  /// Overrules what the measurement says.
  void Judge(LoopEvidence& loop) const;

 private:
  std::vector<PlaceCandidate> rejected_, forced_;
};

}  // namespace parkade
