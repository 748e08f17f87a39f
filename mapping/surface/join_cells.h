#pragma once

#include "core/surface_map.h"

namespace parkade {

/// The cells of a surface, `factor` x `factor` of them joined to one: mean height and color,
/// largest sigma, and as belief the share of it that is free: the mean of the beliefs, where a cell
/// that is not there counts as 0. Kept are joined cells of at least `free_threshold` and those
/// around them; where there is none around, one of belief 0 is added that continues its neighbors'
/// height, so that the outline of what is free lies between joined cells. Those of different decks
/// stay apart (more than `max_step` [m] between neighbors in height).
SurfaceMap JoinCells(const SurfaceMap& surface, int factor, double free_threshold, double max_step);

}  // namespace parkade
