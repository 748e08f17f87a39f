#pragma once

#include <limits>
#include <string>

#include "core/triangle_mesh.h"

namespace parkade {

struct OccupancyGridOptions {
  double resolution = 0.05;                                  ///< [m] of a cell
  double lowest = -std::numeric_limits<double>::infinity();  ///< [m] ground below is left out: one
                                                             ///< deck of several
  double highest = std::numeric_limits<double>::infinity();  ///< [m] ground above is left out
};

/// An occupancy grid as ROS' map_server reads it: an image and its description.
struct OccupancyGrid {
  std::string pgm;   ///< binary 8-bit, north up: 254 free, 205 unknown
  std::string yaml;  ///< `image`, `resolution`, `origin` (lower left corner in site), thresholds
};

/// Cells whose centers lie under or over a triangle are free, all others unknown: what is not
/// drivable was never told apart from what was never seen. `image_name` stands in the description.
/// Throws Error{kInvalidInput} where no ground is left within the heights, Error{kUsage} for a grid
/// of more than 2^28 cells.
OccupancyGrid MakeOccupancyGrid(const TriangleMesh& mesh, const std::string& image_name,
                                const OccupancyGridOptions& options = {});

}  // namespace parkade
