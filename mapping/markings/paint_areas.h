#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/markings/ground_tiles.h"

namespace parkade {

/// One piece of paint that is not just a line: an arrow, a bar of a crossing, a letter.
struct PaintArea {
  std::vector<Eigen::Vector2d> outline;  ///< [m] in site, not closed
  double height = 0;                     ///< [m] in site
  bool is_yellow = false;
};

/// Bright pieces of ground whose middles lie in the core of a tile, at least a hand's breadth
/// inside what is known.
std::vector<PaintArea> FindPaintAreas(const GroundTile& tile);

}  // namespace parkade
