#pragma once

#include <cstdint>

#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Two visits to a spot among random points, seen by four cameras around a car: front, left, right,
/// rear.
struct PlaceWorldOptions {
  Rigid3 a_from_b = {};          ///< level
  double bearing_sigma = 0.002;  ///< [rad]
  double depth_error = 0.05;     ///< of points, relative
  int num_points = 400;
  double wrong_share = 0;  ///< of features of `b` that look like those of another point
  std::uint32_t seed = 1;
};

struct PlaceWorld {
  RigKeyframe a, b;
};

PlaceWorld MakePlaceWorld(const PlaceWorldOptions& options);

}  // namespace parkade
