#pragma once

#include <vector>

#include "core/trajectory.h"
#include "slam/odometry_options.h"

namespace parkade {

/// What was recorded before and a little after the first estimate.
struct EarlyRecords {
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<TrackedFrame> frames;
};

/// Odometry run backwards in time from a known state, for drives that could be
/// started only some way into the log. Played backwards a drive obeys the same
/// laws: velocities and rates change sign, forces do not.
///
/// \param at_end  state at or before the last of the records
/// \return states from the first IMU sample up to at_end.time, in order of time,
///     in the odom frame of at_end; empty where there is nothing before it.
std::vector<TrajectoryState> RunBackwards(const Rig& rig, const OdometryOptions& options, const EarlyRecords& records,
                                          const MotionState& at_end);

}  // namespace parkade
