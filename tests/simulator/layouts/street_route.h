#pragma once

#include "tests/simulator/layouts/street_layout.h"

namespace parkade::simulator {

/// Around the block on the right-hand lane; when it turns around, through the street across.
/// A wish for much less than one round is a part of a round.
RoutePlan PlanStreetRoute(const StreetLayout& layout, const RouteWish& wish);

/// The corners of the right-hand lane around the block, from corner 1 on counter-clockwise, or from
/// corner 0 on clockwise.
std::vector<Eigen::Vector2d> LaneCorners(const StreetLayout& layout, bool is_clockwise);

}  // namespace parkade::simulator
