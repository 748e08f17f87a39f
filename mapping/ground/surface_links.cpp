#include "mapping/ground/surface_links.h"

#include <cmath>
#include <cstdlib>
#include <span>
#include <utility>

namespace parkade {
namespace {

bool IsBefore(const SurfaceCell& cell, int x, int y) {
  return cell.y < y || (cell.y == y && cell.x < x);
}

/// Links each cell with the nearest in height at (x + dx, y + dy); `first` walks along as cells are
/// sorted.
void Link(std::span<const SurfaceCell> cells, int dx, int dy, double max_step,
          std::vector<int>& forward, std::vector<int>& backward) {
  size_t first = 0;
  for (size_t i = 0; i < cells.size(); ++i) {
    const int x = cells[i].x + dx, y = cells[i].y + dy;
    while (first < cells.size() && IsBefore(cells[first], x, y)) ++first;
    int nearest = -1;
    double nearest_step = max_step;
    for (size_t k = first; k < cells.size() && cells[k].x == x && cells[k].y == y; ++k) {
      const double step = std::abs(cells[k].height - cells[i].height);
      if (step <= nearest_step && backward[k] < 0)
        nearest = static_cast<int>(k), nearest_step = step;
    }
    if (nearest < 0) continue;
    forward[i] = nearest;
    backward[static_cast<size_t>(nearest)] = static_cast<int>(i);
  }
}

}  // namespace

std::array<int, 8> SurfaceLinks::Around(int cell) const {
  const auto step = [](const std::vector<int>& next, int from) {
    return from < 0 ? -1 : next[static_cast<size_t>(from)];
  };
  const int east = step(right, cell), west = step(left, cell), north = step(up, cell),
            south = step(down, cell);
  // A corner is reached by either of two ways.
  const auto corner = [&](int sideways, const std::vector<int>& vertical, int ahead,
                          const std::vector<int>& horizontal) {
    const int found = step(vertical, sideways);
    return found >= 0 ? found : step(horizontal, ahead);
  };
  return {east,
          west,
          north,
          south,
          corner(east, up, north, right),
          corner(west, up, north, left),
          corner(east, down, south, right),
          corner(west, down, south, left)};
}

SurfaceLinks LinkCells(const SurfaceMap& surface, double max_step) {
  const size_t count = surface.cells.size();
  SurfaceLinks links{std::vector<int>(count, -1), std::vector<int>(count, -1),
                     std::vector<int>(count, -1), std::vector<int>(count, -1)};
  Link(surface.cells, 1, 0, max_step, links.right, links.left);
  Link(surface.cells, 0, 1, max_step, links.up, links.down);
  return links;
}

}  // namespace parkade
