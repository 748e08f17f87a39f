#pragma once

#include "tests/simulator/layouts/place.h"
#include "tests/simulator/motion/driver_options.h"
#include "tests/simulator/motion/motion.h"

namespace parkade::simulator {

struct DrivePlan {
  Motion motion;
  double length = 0;              ///< [m] traveled
  double min_radius = 0;          ///< [m] of the route
  double max_speed = 0;           ///< [m/s]
  bool returns_to_start = false;  ///< ends within 10 m of its start
  int num_reversals = 0;          ///< changes between forward and reverse
  bool is_parked = false;         ///< whether it backed into a slot
};

/// A drive of `duration` [s] around the place: stands, drives the rounds that
/// fit at 1.5 to 6 m/s, stops once on the way, and ends 3 m past its start.
DrivePlan PlanDrive(const Place& place, double duration, std::uint64_t seed);

/// The drive of these options; `duration` counts where they name no length. The body follows the
/// ground, leans with acceleration and shakes a little on the road.
DrivePlan PlanDrive(const Place& place, const DriverOptions& driver, double duration,
                    std::uint64_t seed);

}  // namespace parkade::simulator
