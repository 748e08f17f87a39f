#include "mapping/surface/surface_options.h"

#include <cmath>

#include "core/error.h"

namespace parkade {

void SurfaceOptions::Validate() const {
  Require(cell_size > 0, ErrorCode::kUsage, "cell_size must be > 0 m");
  Require(method == "surface" || method == "homography", ErrorCode::kUsage,
          "method of the surface must be surface or homography");
  Require(outlines == "observations" || outlines == "network", ErrorCode::kUsage,
          "outlines of the surface must be observations or network");
  height.Validate();
  sweep.Validate();
  const double ratio = height.spacing / cell_size;
  Require(ratio >= 1 && std::abs(ratio - std::round(ratio)) < 1e-6, ErrorCode::kUsage,
          "height.spacing must be a multiple of cell_size");
  Require(max_height_sigma > 0, ErrorCode::kUsage, "max_height_sigma must be > 0 m");
  Require(min_island_area >= 0, ErrorCode::kUsage, "min_island_area must not be negative");
  Require(latest_drives >= 1, ErrorCode::kUsage, "latest_drives must be 1 at least");
  Require(tile_size >= height.spacing, ErrorCode::kUsage,
          "tile_size must be height.spacing at least");
}

}  // namespace parkade
