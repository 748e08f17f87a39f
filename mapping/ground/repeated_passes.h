#pragma once

#include <vector>

#include "core/trajectory.h"

namespace parkade {

/// Stretches of a drive on which the car comes by for yet another time, in the same direction: it
/// did before and will again. Their images look like those of the other passes and err like them,
/// so that they add false certainty, not knowledge. Safe to ask from several threads.
class RepeatedPasses {
 public:
  /// \param odom_from_body  may drift: passes that it lets lie further apart than half a meter are
  ///   no repetitions. Its decks must stay a meter apart.
  /// \param passes  of a place and direction are kept: the first ones and, half of them or one
  ///   more, the last; 0: all
  RepeatedPasses(const Trajectory& odom_from_body, int passes);

  /// False outside the trajectory.
  bool Contains(Timestamp time) const;

 private:
  std::vector<Timestamp> times_;  // at which stretches begin
  std::vector<bool> is_repeated_;
};

}  // namespace parkade
