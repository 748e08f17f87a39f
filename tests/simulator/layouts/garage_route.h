#pragma once

#include "tests/simulator/layouts/garage_layout.h"

namespace parkade::simulator {

/// Tours from the forecourt up by half circles and down by straight ramps, or the other
/// way when reversed, as many and as high as come closest to the length wished for.
RoutePlan PlanGarageRoute(const GarageLayout& layout, const std::vector<ParkingSlot>& slots,
                          const RouteWish& wish);

}  // namespace parkade::simulator
