#include "mapping/surface/free_islands.h"

#include <algorithm>

#include "mapping/ground/surface_links.h"

namespace parkade {

using PaintedCell = SurfacePainter::PaintedCell;

int FreeIslands::Find(int island) {
  while (parents_[static_cast<size_t>(island)] != island) {
    int& parent = parents_[static_cast<size_t>(island)];
    island = parent = parents_[static_cast<size_t>(parent)];
  }
  return island;
}

int FreeIslands::Join(int a, int b) {
  a = Find(a), b = Find(b);
  if (a == b) return a;
  const auto first = static_cast<size_t>(std::min(a, b)),
             second = static_cast<size_t>(std::max(a, b));
  parents_[second] = static_cast<int>(first);
  num_cells_[first] += num_cells_[second];
  is_driven_[first] = is_driven_[first] || is_driven_[second];
  return static_cast<int>(first);
}

int FreeIslands::AddIsland() {
  parents_.push_back(static_cast<int>(parents_.size()));
  num_cells_.push_back(0);
  is_driven_.push_back(false);
  return parents_.back();
}

std::vector<int> FreeIslands::AddRows(std::span<const PaintedCell> cells) {
  // Neighbors are sought among these and the row below them.
  SurfaceMap window;
  window.cells.assign(last_row_.begin(), last_row_.end());
  for (const PaintedCell& cell : cells) window.cells.push_back(cell.cell);
  const SurfaceLinks links = LinkCells(window, max_step_);
  std::vector<int> islands = islands_of_last_row_;
  islands.reserve(window.cells.size());
  for (size_t i = last_row_.size(); i < window.cells.size(); ++i) {
    const PaintedCell& cell = cells[i - last_row_.size()];
    int island = kNone;
    if (cell.is_seen && cell.cell.free_belief > 0.5F) {
      for (const int neighbor : {links.left[i], links.down[i]}) {
        const int other = neighbor < 0 ? kNone : islands[static_cast<size_t>(neighbor)];
        if (other != kNone) island = island == kNone ? Find(other) : Join(island, other);
      }
      if (island == kNone) island = AddIsland();
      ++num_cells_[static_cast<size_t>(island)];
      if (cell.is_driven) is_driven_[static_cast<size_t>(island)] = true;
    }
    islands.push_back(island);
  }
  islands.erase(islands.begin(), islands.begin() + static_cast<std::ptrdiff_t>(last_row_.size()));
  if (cells.empty()) return islands;
  const auto last = std::find_if(cells.rbegin(), cells.rend(), [&](const PaintedCell& cell) {
    return cell.cell.y != cells.back().cell.y;
  });
  const auto count = static_cast<size_t>(last - cells.rbegin());
  last_row_.assign(window.cells.end() - static_cast<std::ptrdiff_t>(count), window.cells.end());
  islands_of_last_row_.assign(islands.end() - static_cast<std::ptrdiff_t>(count), islands.end());
  return islands;
}

bool FreeIslands::IsSmall(int island, double min_cells) {
  const auto first = static_cast<size_t>(Find(island));
  return !is_driven_[first] && static_cast<double>(num_cells_[first]) < min_cells;
}

}  // namespace parkade
