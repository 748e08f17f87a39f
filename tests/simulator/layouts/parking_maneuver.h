#pragma once

#include <optional>
#include <vector>

#include "tests/simulator/layouts/place.h"
#include "tests/simulator/motion/drive_path.h"

namespace parkade::simulator {

/// The own car's outline in body.
struct CarOutline {
  double front, rear;       ///< [m] ahead of the rear axle; the rear is negative
  double half_width = 0.9;  ///< [m] without mirrors
};
CarOutline OwnCarOutline();

/// Drives `plan`'s way to its slot, or to the next free one beside its last side: past it along the
/// aisle, back into it, and, where wished, out again in the direction it came from. Nothing when
/// there is no slot with a way into it that keeps a hand's breadth to kerbs and cars.
std::optional<std::vector<Leg>> PlanParking(const Place& place, const RoutePlan& plan,
                                            bool leaves_again);

}  // namespace parkade::simulator
