#pragma once

#include <optional>

#include "core/rigid3.h"
#include "core/surface_map.h"

namespace parkade {

/// [m] by which the later version's drivable ground lies above the earlier one's in the median,
/// decks nearest to each other compared; nothing where less than 2 m^2 lies in both. `to_from_from`
/// takes the earlier site into the later one. O(number of cells).
std::optional<double> MedianRise(const SurfaceMap& from, const SurfaceMap& to,
                                 const Rigid3& to_from_from);

}  // namespace parkade
