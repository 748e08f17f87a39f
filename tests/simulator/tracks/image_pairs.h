#pragma once

#include <functional>
#include <vector>

#include "tests/simulator/drives/simulate_drive.h"
#include "tests/simulator/tracks/kept_tracks.h"

namespace parkade::simulator {

/// Which images of a drive to take.
struct PairOptions {
  double every = 3;      ///< [s] from pair to pair
  double slowest = 1.5;  ///< [m/s] where the car is slower there is no pair
};

/// Two images in a row, as gray JPEGs decode, and what became of the corners of the first in the
/// second.
struct ImagePair {
  size_t camera = 0;
  double time = 0;           ///< [s] of the first since the start of the drive
  double speed = 0;          ///< [m/s]
  double turn_rate = 0;      ///< [rad/s]
  cv::Mat before, after;     ///< CV_8UC1
  FollowedCorners followed;  ///< of 200
};

/// Renders pairs of images of the drive that these options describe, without faults, 1 /
/// cameras.rate apart, for each camera, and hands over each.
void TakeImagePairs(const SimulateOptions& options, const PairOptions& pairs,
                    const std::function<void(const ImagePair&)>& take);

}  // namespace parkade::simulator
