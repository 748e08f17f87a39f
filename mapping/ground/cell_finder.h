#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/surface_map.h"

namespace parkade {

/// Finds cells of a surface by their place. The surface is borrowed. Takes a quarter of a byte per
/// cell where ground is dense, and little more for what lies between.
class CellFinder {
 public:
  explicit CellFinder(const SurfaceMap& surface);

  /// The cell nearest to a point that lies on the surface or at most two cells off its border; null
  /// further away.
  const SurfaceCell* Find(const Eigen::Vector3d& point_in_site) const;

  const SurfaceMap& surface() const { return *surface_; }

 private:
  /// The cells of one y, in blocks of so many x.
  static constexpr int kBlock = 16;
  struct Row {
    int first_x = 0;
    std::uint32_t num_blocks = 0;
    std::size_t first_cell = 0, first_block = 0;
  };

  std::span<const SurfaceCell> At(int x, int y) const;

  const SurfaceMap* surface_;
  int first_y_ = 0;
  std::vector<Row> rows_;
  std::vector<std::uint32_t>
      blocks_;  // of rows: where each begins, and the last ends, from the row's first cell
};

}  // namespace parkade
