#pragma once

#include <span>
#include <vector>

#include "mapping/roadside/parking_lane.h"

namespace parkade {

/// A stretch of a parking lane that one car takes.
struct LaneSlot {
  double begin = 0, end = 0;  ///< [m] along the lane
  double confidence = 0;      ///< 0 to 1
  bool is_occupied = false;

  double Middle() const { return 0.5 * (begin + end); }
};

/// Slots that no line divides, told by the cars that stand in a lane and by what is free between
/// them.
///
/// Cars that stand at multiples of one pitch, each a little off, are a row. Where a car is missing
/// in it, and bare ground is seen, is a slot too, less surely, and so is the first place beyond its
/// ends. In their order along the lane. O(states).
std::vector<LaneSlot> FindLaneSlots(std::span<const LaneState> states, double step);

}  // namespace parkade
