#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "core/surface_map.h"

namespace parkade {

/// Calls `visit(cells)` with the cells of each row that lie in a window, from the lowest y to the
/// highest; rows without any are left out. The window is in cells, the last being the one before
/// max().
template <typename Visitor>
void VisitRows(const SurfaceMap& surface, const Eigen::AlignedBox2i& window, const Visitor& visit) {
  const auto find = [](auto begin, auto end, int y, int x) {
    return std::lower_bound(
        begin, end, std::pair(y, x), [](const SurfaceCell& cell, const std::pair<int, int>& at) {
          return cell.y < at.first || (cell.y == at.first && cell.x < at.second);
        });
  };
  const auto last = find(surface.cells.begin(), surface.cells.end(), window.max().y(),
                         std::numeric_limits<int>::min());
  auto begin = surface.cells.begin();
  for (int y = window.min().y(); y < window.max().y(); ++y) {
    begin = find(begin, last, y, window.min().x());
    if (begin == last) return;
    if (begin->y > y) {
      y = begin->y - 1;  // rows without cells
      continue;
    }
    const auto end = find(begin, last, y, window.max().x());
    if (begin != end) visit(std::span<const SurfaceCell>(begin, end));
    begin = end;
  }
}

/// The cells in a window, as a surface.
inline SurfaceMap CutOut(const SurfaceMap& surface, const Eigen::AlignedBox2i& window) {
  SurfaceMap part{surface.cell_size, {}};
  VisitRows(surface, window, [&](std::span<const SurfaceCell> cells) {
    part.cells.insert(part.cells.end(), cells.begin(), cells.end());
  });
  return part;
}

}  // namespace parkade
