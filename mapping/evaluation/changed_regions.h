#pragma once

#include <cstddef>
#include <vector>

#include "core/surface_changes.h"
#include "core/surface_map.h"
#include "mapping/ground/surface_links.h"

namespace parkade {

/// A cell of one kind of change, in the later grid.
struct ChangedCell {
  SurfaceCell cell;
  double height_change = 0;
  bool is_obstacle = false;  ///< in the version in which it is not drivable, for sure
};

/// Cells of one kind of change with their neighbors of the same kind.
class CellPatches {
 public:
  /// The cells are borrowed.
  CellPatches(const std::vector<ChangedCell>& cells, double cell_size);

  /// Takes away what is narrower than 2 * `rounds` + 1 cells.
  void Open(int rounds);

  /// Connected through edges, each in the order of the cells.
  std::vector<std::vector<size_t>> FindParts() const;

  ChangedRegion RegionOf(GroundChange change, const std::vector<size_t>& part) const;

 private:
  int CountAround(size_t cell, const std::vector<bool>& is_in) const;
  template <typename Rule>
  void Step(const Rule& rule);

  const std::vector<ChangedCell>& cells_;
  double cell_size_;
  std::vector<bool> is_in_;
  SurfaceLinks links_;
};

}  // namespace parkade
