#pragma once

#include <vector>

#include "core/rig.h"
#include "core/trajectory.h"
#include "slam/factors/motion_state.h"
#include "slam/odometry/early_records.h"

namespace parkade {

// For drives that could be started only some way into the log: their odometry runs backwards in
// time from a known state. Played backwards a drive obeys the same laws: velocities and rates
// change sign, forces do not.

/// A drive played backwards from `start.time`, at which times are mirrored.
struct ReversedDrive {
  Rig rig;
  MotionState start;
  EarlyRecords records;  ///< in order of the mirrored time
};

/// \param at_end  state at or before the last of the records; later records are left out
ReversedDrive ReverseTime(const Rig& rig, const EarlyRecords& records, const MotionState& at_end);

/// The states of a drive that was played backwards, mirrored again at `about`, in order of time.
std::vector<TrajectoryState> ReverseTime(std::vector<TrajectoryState> states, Timestamp about);

}  // namespace parkade
