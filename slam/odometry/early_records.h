#pragma once

#include <vector>

#include "core/drive_log.h"
#include "slam/tracking/feature_track.h"

namespace parkade {

/// What was recorded before and a little after the first estimate.
struct EarlyRecords {
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<TrackedFrame> frames;
};

}  // namespace parkade
