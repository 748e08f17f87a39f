#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "core/surface_map.h"
#include "mapping/ground/driven_path.h"

namespace parkade {

/// Ridges that cars drove over: places of a path that lie higher than the straight line between the
/// ground before and behind them. The same bump of several passes counts once. What lies beside the
/// path has no heights of its own to be found in; kerbs have a sweep of theirs (FindKerbs).
std::vector<SpeedBump> FindSpeedBumps(const SurfaceMap& surface, std::span<const DrivenPath> paths);

}  // namespace parkade
