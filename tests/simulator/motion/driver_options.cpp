#include "tests/simulator/motion/driver_options.h"

#include "core/error.h"

namespace parkade::simulator {

void DriverOptions::Validate() const {
  Require(length >= 0 && length <= 5000 && (length == 0 || length >= 20), ErrorCode::kUsage,
          "drive.length must be 20 to 5000 m, or 0");
  Require(max_speed >= 1 && max_speed <= 7, ErrorCode::kUsage,
          "drive.max_speed must be 1 to 7 m/s");
  Require(initial_stand >= 0 && initial_stand <= 300 && final_stand >= 0 && final_stand <= 300 &&
              parked_stand >= 0 && parked_stand <= 300,
          ErrorCode::kUsage, "the car stands 0 to 300 s at the start, in a slot, and at the end");
  Require(stops.size() <= 20, ErrorCode::kUsage, "drive.stops are at most 20");
  for (const double stop : stops)
    Require(stop >= 0 && stop <= 300, ErrorCode::kUsage, "a stop takes 0 to 300 s");
  Require(rolling_start >= 0 && rolling_start <= 6, ErrorCode::kUsage,
          "drive.rolling_start must be 0 to 6 m/s");
  Require(suspension >= 0 && suspension <= 5, ErrorCode::kUsage, "drive.suspension must be 0 to 5");
  Require(parks || !leaves_slot, ErrorCode::kUsage, "drive.leaves_slot needs drive.parks");
}

}  // namespace parkade::simulator
