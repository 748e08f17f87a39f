#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "core/surface_map.h"
#include "mapping/ground/driven_path.h"

namespace parkade {

struct SpeedBumpOptions {
  double min_height = 0.03;  ///< [m] above the ground before and behind
  double max_height = 0.25;  ///< [m]
  double max_length = 5.0;   ///< [m] along the way
  double spacing = 0.1;      ///< [m] at which the driven heights are compared
  void Validate() const;     ///< throws Error{kUsage}
};

/// Ridges that cars drove over: places of a path that lie higher than the straight line between the
/// ground before and behind them. The same bump of several passes counts once. What lies beside the
/// path has no heights of its own to be found in; kerbs have a sweep of theirs (FindKerbs).
std::vector<SpeedBump> FindSpeedBumps(const SurfaceMap& surface, std::span<const DrivenPath> paths,
                                      const SpeedBumpOptions& options = {});

}  // namespace parkade
