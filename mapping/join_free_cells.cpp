#include "mapping/join_free_cells.h"

#include <algorithm>
#include <tuple>
#include <vector>

namespace parkade {
namespace {

int FloorDivide(int value, int divisor) { return (value - (value < 0 ? divisor - 1 : 0)) / divisor; }

/// The mean of cells [begin, end) as the cell at (x, y).
SurfaceCell Join(const SurfaceCell* begin, const SurfaceCell* end, int x, int y) {
  SurfaceCell joined{.x = x, .y = y};
  std::array<int, 3> color{};
  const auto count = static_cast<int>(end - begin);
  for (const SurfaceCell* cell = begin; cell != end; ++cell) {
    joined.height += cell->height / static_cast<float>(count);
    joined.free_belief += cell->free_belief / static_cast<float>(count);
    joined.height_sigma = std::max(joined.height_sigma, cell->height_sigma);
    for (size_t c = 0; c < 3; ++c) color[c] += cell->color[c];
  }
  for (size_t c = 0; c < 3; ++c) joined.color[c] = static_cast<std::uint8_t>((color[c] + count / 2) / count);
  return joined;
}

}  // namespace

SurfaceMap JoinFreeCells(const SurfaceMap& surface, int factor, double free_threshold, double max_step) {
  std::vector<SurfaceCell> free_cells;
  for (const SurfaceCell& cell : surface.cells)
    if (static_cast<double>(cell.free_belief) >= free_threshold) free_cells.push_back(cell);
  const auto block = [&](const SurfaceCell& cell) {
    return std::pair(FloorDivide(cell.y, factor), FloorDivide(cell.x, factor));
  };
  std::sort(free_cells.begin(), free_cells.end(), [&](const SurfaceCell& a, const SurfaceCell& b) {
    return std::tuple(block(a), a.height, a.y, a.x) < std::tuple(block(b), b.height, b.y, b.x);
  });
  SurfaceMap joined{surface.cell_size * factor, {}};
  for (size_t begin = 0, end; begin < free_cells.size(); begin = end) {
    for (end = begin + 1; end < free_cells.size() && block(free_cells[end]) == block(free_cells[begin]) &&
                          static_cast<double>(free_cells[end].height - free_cells[end - 1].height) <= max_step;)
      ++end;
    if (2 * (end - begin) < static_cast<size_t>(factor * factor)) continue;
    const auto [y, x] = block(free_cells[begin]);
    joined.cells.push_back(Join(&free_cells[begin], &free_cells[begin] + (end - begin), x, y));
  }
  return joined;
}

}  // namespace parkade
