#pragma once

#include <cstdint>
#include <vector>

#include "core/trajectory.h"
#include "slam/loops/close_loops.h"

namespace parkade {

struct WrongLoopOptions {
  double share = 0;  ///< of all loops
  int group = 1;     ///< of so many that agree with each other
  std::uint32_t seed = 1;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("share", share);
    visit("group", group);
    visit("seed", seed);
  }
};

/// What became of a drive's loops once wrong ones were mixed in.
struct MixedLoops {
  size_t num_right = 0, num_wrong = 0;  ///< that went into the graph
  size_t num_right_lost = 0, num_wrong_kept = 0;
  Trajectory odom_from_body;  ///< carried along with the keyframes
};

/// Closes a drive again with the loops of `closure` (ways "rig" and "pnp") that it accepted, and
/// wrong ones until they are `wrong.share` of all: between keyframes that the gates of recognition
/// let pass, level as gravity wants it, at random within `options.recognition.drift_base` and at
/// any heading, weighted like random right ones. They come in groups that agree with each other:
/// the keyframes after the first two seem to lie as odometry says, as in rows that look alike.
MixedLoops MixInWrongLoops(const Trajectory& odometry, const LoopClosure& closure,
                           const LoopOptions& options, const WrongLoopOptions& wrong);

}  // namespace parkade
