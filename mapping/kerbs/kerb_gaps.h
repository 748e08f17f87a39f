#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "core/surface_map.h"
#include "mapping/kerbs/kerb_walk.h"

namespace parkade {

/// Kerbs go on behind parked cars: the line of each end is followed (KerbWalker), from the longest
/// kerb on; where an end has none and the kerb is rectangular, the side around the corner is. Kerbs
/// that meet so and agree in height become one; others grow to the last place where something looks
/// like a kerb, if that is 2 m away. What hooks around the corners of cars is cut off there. What
/// nobody saw of a kerb is its `hidden_length`. O(kerbs squared).
void CloseGaps(const SurfaceMap& surface, std::span<const NoKerb> no_kerbs,
               std::vector<Kerb>& kerbs);

}  // namespace parkade
