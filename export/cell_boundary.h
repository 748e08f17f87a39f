#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/surface_map.h"

namespace parkade {

/// A closed line whose last point is not repeated; (x, y) at cell corners, z the height of a cell
/// there.
using Ring = std::vector<Eigen::Vector3d>;

/// The boundary of cells that are connected through edges, no two at one (x, y): first the outer
/// ring, counter- clockwise from above, then the holes, clockwise. Rings may touch each other in
/// corners and never cross (valid as OGC polygon). Only corners are kept. The result does not
/// depend on the order of the cells.
std::vector<Ring> TraceBoundary(std::span<const SurfaceCell> cells, double cell_size);

/// [m^2], positive for a counter-clockwise ring.
double SignedArea(const Ring& ring);

/// One key per cell index.
inline std::int64_t CellKey(int x, int y) {
  // Order of keys is order of (y, x).
  return static_cast<std::int64_t>(y) * (std::int64_t{1} << 32) + x;
}

}  // namespace parkade
