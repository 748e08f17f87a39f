#pragma once

#include "tests/simulator/motion.h"
#include "tests/simulator/place.h"
#include "tests/simulator/speed_profile.h"

namespace parkade::simulator {

struct DrivePlan {
  Motion motion;
  double length = 0;              ///< [m] travelled
  double min_radius = 0;          ///< [m] of the route
  double max_speed = 0;           ///< [m/s]
  bool returns_to_start = false;  ///< false: the drive was too short for a round
};

/// A drive of `duration` [s] around the place: stands, drives the rounds that
/// fit at 1.5 to 6 m/s, stops once on the way, and ends 3 m past its start. The body
/// follows the ground, leans with acceleration and shakes a little on the road.
DrivePlan PlanDrive(const Place& place, double duration, std::uint64_t seed);

}  // namespace parkade::simulator
