#pragma once

#include "core/surface_map.h"

namespace parkade {

/// The free cells of a surface, `factor` x `factor` of them joined to one: mean height and colour, largest sigma,
/// mean belief. Joined cells exist where at least half of their cells are free. Those of different decks stay
/// apart (more than `max_step` [m] between neighbours in height).
SurfaceMap JoinFreeCells(const SurfaceMap& surface, int factor, double free_threshold, double max_step);

}  // namespace parkade
