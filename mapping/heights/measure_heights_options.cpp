#include "mapping/heights/measure_heights_options.h"

#include "core/error.h"

namespace parkade {

void MeasureHeightsOptions::Validate() const {
  Require(num_steps >= 2, ErrorCode::kUsage, "num_steps must be 2 at least");
  Require(cell_size > 0 && window >= 2 * cell_size, ErrorCode::kUsage,
          "window must be two cell_size at least");
  Require(max_distance > 0, ErrorCode::kUsage, "max_distance must be > 0 m");
  Require(max_views >= 4, ErrorCode::kUsage, "max_views must be 4 at least");
}

}  // namespace parkade
