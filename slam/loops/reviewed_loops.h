#pragma once

#include "slam/loops/loop_closure.h"

namespace parkade {

/// A review's decisions on the keyframes of one drive.
class ReviewedLoops {
 public:
  /// Throws Error{kUsage} for an id that names no keyframes of this drive.
  ReviewedLoops(const LoopReview& review, size_t num_keyframes);

  /// Marks the keyframes of forced loops, and their neighbors, as wanted.
  void MarkKeyframes(std::vector<bool>& is_wanted) const;
  /// Adds forced loops that recognition did not propose, at the end.
  void AddForced(std::vector<PlaceCandidate>& candidates) const;
  /// Overrules what the measurement of a loop says.
  void Judge(LoopEvidence& loop) const;

 private:
  std::vector<PlaceCandidate> rejected_, forced_;
};

}  // namespace parkade
