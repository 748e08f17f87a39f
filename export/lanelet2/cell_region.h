#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "export/cell_boundary.h"

namespace parkade {

/// Cells `begin` to `end` - 1 of the row `y` (SurfaceCell's indices).
struct CellSpan {
  int y = 0, begin = 0, end = 0;

  bool operator==(const CellSpan&) const = default;
};

/// A set of cells as spans, sorted by (y, begin), that neither overlap nor touch within a row: as
/// small as its boundary, however large its area.
using CellRegion = std::vector<CellSpan>;

/// The cells within closed lines along cell corners, those within an even number of them left out.
CellRegion FillRings(std::span<const Ring> rings, double cell_size);

/// All cells that a convex polygon covers or touches.
CellRegion FillTouched(std::span<const Eigen::Vector2d> polygon, double cell_size);

CellRegion Unite(const CellRegion& a, const CellRegion& b);
CellRegion Subtract(const CellRegion& a, const CellRegion& b);
CellRegion Intersect(const CellRegion& a, const CellRegion& b);

/// The number of cells.
long CountCells(const CellRegion& region);

/// The pieces that are connected through edges of cells, in the order of their first cells.
std::vector<CellRegion> SplitIntoPieces(const CellRegion& region);

/// TraceBoundary of the region; all z are 0.
std::vector<Ring> TraceBoundary(const CellRegion& region, double cell_size);

}  // namespace parkade
