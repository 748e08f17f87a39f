#pragma once

#include <cstdint>

#include "core/files/file_backed_vector.h"
#include "mapping/ground/cell_finder.h"

namespace parkade {

/// How far free ground reaches around free ground, so that who walks over it need not look at each
/// cell. The cells are borrowed. Takes a byte per cell.
class FreeClearance {
 public:
  explicit FreeClearance(const CellFinder& cells);

  /// So many cells to each side of a cell of the surface, corners included, all ground is free and
  /// of one level; 0 where this cell or one beside it is not.
  int Around(const SurfaceCell& cell) const;
  /// [m] in x and in y, within which the same holds around a place; 0 where `cell` is another's.
  double Around(const Eigen::Vector2d& place, const SurfaceCell& cell) const;

  const CellFinder& cells() const { return *cells_; }

 private:
  const CellFinder* cells_;
  FileBackedVector<std::uint8_t> radii_;  // and one more where the cell itself is such ground
};

}  // namespace parkade
