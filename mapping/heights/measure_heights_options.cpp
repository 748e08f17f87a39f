#include "mapping/heights/measure_heights_options.h"

#include "core/error.h"

namespace parkade {

void MeasureHeightsOptions::Validate() const {
  Require(num_rounds >= 0 && num_steps >= 2, ErrorCode::kUsage,
          "num_rounds must be >= 0 and num_steps >= 2");
  Require(cell_size > 0 && window >= 2 * cell_size, ErrorCode::kUsage,
          "window must be two cell_size at least");
  Require(max_offset > 0 && max_distance > 0 && sigma > 0, ErrorCode::kUsage,
          "max_offset, max_distance and sigma must be > 0 m");
  Require(max_views >= 4, ErrorCode::kUsage, "max_views must be 4 at least");
  Require(min_contrast >= 0 && min_observations > 1 && max_jump > 0, ErrorCode::kUsage,
          "min_contrast must not be negative, max_jump > 0 m and min_observations > 1");
}

}  // namespace parkade
