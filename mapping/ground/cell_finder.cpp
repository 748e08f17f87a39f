#include "mapping/ground/cell_finder.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

/// The first of some cells of a row that lies at `x` or beyond.
const SurfaceCell* FirstAt(int x, const SurfaceCell* begin, const SurfaceCell* end) {
  if (begin == end) return end;
  // Most rows are without gaps, and of one level.
  const SurfaceCell* guess = begin + std::clamp<std::ptrdiff_t>(x - begin->x, 0, end - begin - 1);
  if (guess->x == x && (guess == begin || guess[-1].x < x)) return guess;
  return std::lower_bound(begin, end, x,
                          [](const SurfaceCell& cell, int at) { return cell.x < at; });
}

}  // namespace

CellFinder::CellFinder(const SurfaceMap& surface) : surface_(&surface) {
  const auto& cells = surface.cells;
  if (cells.empty()) return;
  first_y_ = cells.front().y;
  rows_.resize(static_cast<std::size_t>(cells.back().y - first_y_) + 1);
  std::size_t released = 0;
  for (std::size_t begin = 0, end; begin < cells.size(); begin = end) {
    Row& row = rows_[static_cast<std::size_t>(cells[begin].y - first_y_)];
    row = {.first_x = cells[begin].x,
           .num_blocks = 0,
           .first_cell = begin,
           .first_block = blocks_.size()};
    for (end = begin; end < cells.size() && cells[end].y == cells[begin].y; ++end) {
      const auto block = static_cast<std::uint32_t>((cells[end].x - row.first_x) / kBlock);
      for (; row.num_blocks <= block; ++row.num_blocks)
        blocks_.push_back(static_cast<std::uint32_t>(end - begin));
    }
    blocks_.push_back(static_cast<std::uint32_t>(end - begin));
    if ((end - released) * sizeof(SurfaceCell) < kMinScratchBytes && end < cells.size()) continue;
    ReleaseMemory(cells);
    released = end;
  }
}

const SurfaceCell* CellFinder::Find(const Eigen::Vector3d& point_in_site) const {
  const double size = surface_->cell_size;
  const int x = static_cast<int>(std::floor(point_in_site.x() / size));
  const int y = static_cast<int>(std::floor(point_in_site.y() / size));
  const std::span<const SurfaceCell> here = At(x, y);
  if (here.size() == 1) return here.data();
  const SurfaceCell* nearest = nullptr;
  double nearest_distance = 0;
  // A point on the border of a cell may round into a neighbor that does not exist.
  for (int ring = 0; nearest == nullptr && ring <= 2; ++ring)
    for (int dy = -ring; dy <= ring; ++dy)
      for (int dx = -ring; dx <= ring; ++dx)
        for (const SurfaceCell& cell : At(x + dx, y + dy)) {
          const double distance = std::abs(static_cast<double>(cell.height) - point_in_site.z()) +
                                  std::hypot((cell.x + 0.5) * size - point_in_site.x(),
                                             (cell.y + 0.5) * size - point_in_site.y());
          if (nearest == nullptr || distance < nearest_distance)
            nearest = &cell, nearest_distance = distance;
        }
  return nearest;
}

std::span<const SurfaceCell> CellFinder::At(int x, int y) const {
  if (y < first_y_ || static_cast<std::size_t>(y - first_y_) >= rows_.size()) return {};
  const Row& row = rows_[static_cast<std::size_t>(y - first_y_)];
  const auto block = static_cast<std::uint32_t>((x - row.first_x) / kBlock);
  if (x < row.first_x || block >= row.num_blocks) return {};
  const SurfaceCell* cells = surface_->cells.data() + row.first_cell;
  const SurfaceCell* begin = cells + blocks_[row.first_block + block];
  const SurfaceCell* end = cells + blocks_[row.first_block + block + 1];
  begin = FirstAt(x, begin, end);
  const SurfaceCell* last = begin;
  while (last != end && last->x == x) ++last;
  return {begin, last};
}

}  // namespace parkade
