#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/files/file_backed_vector.h"
#include "core/surface_class.h"

namespace parkade {

/// One horizontal cell of one level of the fused ground.
struct SurfaceCell {
  int x = 0, y = 0;        ///< cell index: center at ((x + 0.5) * cell_size, (y + 0.5) * cell_size)
  float height = 0;        ///< [m] in site
  float height_sigma = 0;  ///< [m]
  float free_belief = 0;   ///< P(drivable) in [0, 1]; cells that were never seen are not in the map
  std::array<std::uint8_t, 3> color{};  ///< sRGB
  /// P(SurfaceClass) in 255ths, by what images show; all 0 where they tell none.
  std::array<std::uint8_t, kNumSurfaceClasses> class_beliefs{};

  /// The likeliest class that agrees with what the map says of driving, which knows more than
  /// images: how high the ground lies, and where cars drove.
  SurfaceClass Surface() const {
    const auto first = class_beliefs.begin(), others = first + kNumClassesForCars;
    const bool is_free = free_belief > 0.5F;
    const auto best =
        is_free ? std::max_element(first, others) : std::max_element(others, class_beliefs.end());
    if (*best > 0) return static_cast<SurfaceClass>(best - first);
    return is_free ? SurfaceClass::kDrivable : SurfaceClass::kUnknown;
  }
};

/// The fused multi-level ground as a sparse grid: several cells may share (x, y)
/// when decks lie above each other. Unknown is not free.
struct SurfaceMap {
  double cell_size = 0.1;               ///< [m]
  FileBackedVector<SurfaceCell> cells;  ///< sorted by (y, x, height)
};

}  // namespace parkade
