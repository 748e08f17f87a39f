#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace parkade {

/// What the observations of a cell of the ground have in common and where they differ, in six
/// bytes.
struct ObservationSummary {
  std::uint8_t free = 0,
               occupied =
                   0;  ///< sums of log-odds for and against drivable ground, see UnpackLogOdds
  std::uint8_t nearness = 0;      ///< rank of the nearest observation
  std::uint8_t disagreement = 0;  ///< largest difference of lightness among the nearest
  std::uint8_t free_views = 0,
               occupied_views = 0;  ///< directions and distances from which it was seen as that

  /// Kept as the root: large sums need no fine steps.
  static constexpr float kSteps = 32;
  static std::uint8_t PackLogOdds(float sum) {
    return static_cast<std::uint8_t>(std::lround(std::min(255.0F, kSteps * std::sqrt(sum))));
  }
};

}  // namespace parkade
