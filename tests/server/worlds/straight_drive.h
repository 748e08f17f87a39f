#pragma once

#include <utility>
#include <vector>

#include "core/trajectory.h"

namespace parkade {

/// A drive of `length` [m] along x from the origin, a pose every half meter.
inline Trajectory StraightDrive(double length) {
  std::vector<TrajectoryState> states;
  for (int i = 0; 0.5 * i <= length; ++i) {
    TrajectoryState state;
    state.time = TimestampFromSeconds(0.1 * i);
    state.world_from_body.translation = {0.5 * i, 0, 0};
    states.push_back(state);
  }
  return Trajectory(std::move(states));
}

}  // namespace parkade
