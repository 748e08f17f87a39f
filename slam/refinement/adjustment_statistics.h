#pragma once

#include <cstddef>

namespace parkade {

struct AdjustedDrive;

/// Median squared errors per degree of freedom, for the IMU their mean: 1 where errors are as large
/// as was thought.
struct AdjustmentStatistics {
  double imu = 0, wheels = 0, bearings = 0, loops = 0, unused_loops = 0, gnss = 0;
  double unused_bearings = 0;  ///< of tracks held out, a robust mean
  size_t num_bearings = 0, num_landmarks = 0;
};

/// How well a drive's states, as they are, agree with its measurements.
AdjustmentStatistics StatisticsOf(const AdjustedDrive& drive);

}  // namespace parkade
