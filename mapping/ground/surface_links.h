#pragma once

#include <vector>

#include "core/surface_map.h"

namespace parkade {

/// For each cell of a surface the neighbor on the same deck, or -1.
struct SurfaceLinks {
  std::vector<int> left, right, down, up;  ///< at x - 1, x + 1, y - 1, y + 1

  /// The eight around a cell, -1 where there is none.
  std::array<int, 8> Around(int cell) const;
};

/// Neighbors are on the same deck when their heights differ by at most `max_step` [m]; of several
/// the nearest. Links are mutual. O(number of cells); the cells must be sorted as SurfaceMap says.
SurfaceLinks LinkCells(const SurfaceMap& surface, double max_step);

}  // namespace parkade
