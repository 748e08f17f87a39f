#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/file_backed_vector.h"

namespace parkade {

/// One horizontal cell of one level of the fused ground.
struct SurfaceCell {
  int x = 0, y = 0;        ///< cell index: center at ((x + 0.5) * cell_size, (y + 0.5) * cell_size)
  float height = 0;        ///< [m] in site
  float height_sigma = 0;  ///< [m]
  float free_belief = 0;   ///< P(drivable) in [0, 1]; cells that were never seen are not in the map
  std::array<std::uint8_t, 3> color{};  ///< sRGB
};

/// The fused multi-level ground as a sparse grid: several cells may share (x, y)
/// when decks lie above each other. Unknown is not free.
struct SurfaceMap {
  double cell_size = 0.1;               ///< [m]
  FileBackedVector<SurfaceCell> cells;  ///< sorted by (y, x, height)
};

}  // namespace parkade
