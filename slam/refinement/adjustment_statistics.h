#pragma once

#include <cstddef>

namespace parkade {

/// Median squared errors per degree of freedom: 1 where errors are as large as was thought. Of the
/// IMU the mean.
struct AdjustmentStatistics {
  double imu = 0, wheels = 0, bearings = 0, loops = 0, unused_loops = 0, gnss = 0;
  double unused_bearings = 0;  ///< of tracks held out, a robust mean
  size_t num_bearings = 0, num_landmarks = 0;
};

}  // namespace parkade
