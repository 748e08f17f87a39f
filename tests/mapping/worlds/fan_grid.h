#pragma once

#include <cmath>

#include "mapping/ground/ground_grid.h"

namespace parkade {

inline constexpr int kRays = 60, kRanges = 80;

/// A fan of rays with places every 10 cm, all visible: colors can be painted on it directly.
inline GroundGrid MakeFan() {
  GroundGrid grid{.num_rays = kRays,
                  .num_ranges = kRanges,
                  .angle_step = 0.02,
                  .ranges = {},
                  .pixel_lengths = std::vector<float>(kRanges, 0.1F),
                  .cells = {}};
  for (int range = 0; range < kRanges; ++range)
    grid.ranges.push_back(0.1F * static_cast<float>(range + 5));
  for (int ray = 0; ray < kRays; ++ray)
    for (int range = 0; range < kRanges; ++range) {
      const float angle = 0.02F * static_cast<float>(ray),
                  radius = grid.ranges[static_cast<size_t>(range)];
      grid.cells.push_back({.pixel = {static_cast<float>(ray), static_cast<float>(range)},
                            .point_in_ground = {radius * std::cos(angle), radius * std::sin(angle)},
                            .weight = 1,
                            .is_visible = true});
    }
  return grid;
}

}  // namespace parkade
