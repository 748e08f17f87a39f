#include "mapping/cell_finder.h"

#include <cmath>

namespace parkade {

CellFinder::CellFinder(const SurfaceMap& surface) : surface_(&surface) {
  first_at_.reserve(surface.cells.size());
  for (std::size_t i = 0; i < surface.cells.size(); ++i)
    first_at_.try_emplace(KeyOf(surface.cells[i].x, surface.cells[i].y), i);
}

const SurfaceCell* CellFinder::Find(const Eigen::Vector3d& point_in_site) const {
  const double size = surface_->cell_size;
  const int x = static_cast<int>(std::floor(point_in_site.x() / size));
  const int y = static_cast<int>(std::floor(point_in_site.y() / size));
  const SurfaceCell* nearest = nullptr;
  double nearest_distance = 0;
  // A point on the border of a cell may round into a neighbour that does not exist.
  for (int ring = 0; nearest == nullptr && ring <= 2; ++ring)
    for (int dy = -ring; dy <= ring; ++dy)
      for (int dx = -ring; dx <= ring; ++dx)
        for (const SurfaceCell& cell : At(x + dx, y + dy)) {
          const double distance =
              std::abs(static_cast<double>(cell.height) - point_in_site.z()) +
              std::hypot((cell.x + 0.5) * size - point_in_site.x(), (cell.y + 0.5) * size - point_in_site.y());
          if (nearest == nullptr || distance < nearest_distance) nearest = &cell, nearest_distance = distance;
        }
  return nearest;
}

std::span<const SurfaceCell> CellFinder::At(int x, int y) const {
  const auto found = first_at_.find(KeyOf(x, y));
  if (found == first_at_.end()) return {};
  std::size_t end = found->second;
  while (end < surface_->cells.size() && surface_->cells[end].x == x && surface_->cells[end].y == y) ++end;
  return {surface_->cells.data() + found->second, end - found->second};
}

}  // namespace parkade
