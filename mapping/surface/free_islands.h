#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mapping/surface/surface_painter.h"

namespace parkade {

/// Connected free ground, found while the cells come row after row: in memory are one row and three
/// numbers per island. What lies in several islands at first and is joined by a later row is one in
/// the end.
class FreeIslands {
 public:
  static constexpr int kNone = -1;

  /// \param max_step  [m] of height between neighbors
  explicit FreeIslands(double max_step) : max_step_(max_step) {}

  /// The cells of whole rows, above all rows that came before, sorted as SurfaceMap -> for each the
  /// island that it belongs to, kNone where it is not free.
  std::vector<int> AddRows(std::span<const SurfacePainter::PaintedCell> cells);

  /// Once all rows are there: whether an island has fewer cells and no car drove on it.
  bool IsSmall(int island, double min_cells);

 private:
  int Find(int island);
  int Join(int a, int b);
  int AddIsland();

  double max_step_;
  std::vector<SurfaceCell> last_row_;
  std::vector<int> islands_of_last_row_;
  std::vector<int>
      parents_;  // of islands; its own where it is the first of those that it was joined with
  std::vector<std::int64_t> num_cells_;  // of these
  std::vector<bool> is_driven_;
};

}  // namespace parkade
