#include "mapping/mesh/mesh_options.h"

#include "core/error.h"

namespace parkade {

void MeshOptions::Validate() const {
  Require(free_threshold > 0 && free_threshold < 1, ErrorCode::kUsage,
          "free_threshold must be in (0, 1)");
  Require(max_step > 0, ErrorCode::kUsage, "max_step must be > 0 m");
  Require(max_height_error > 0, ErrorCode::kUsage, "max_height_error must be > 0 m");
  Require(window_size > 0, ErrorCode::kUsage, "window_size must be > 0 m");
  Require(color_contrast >= 0, ErrorCode::kUsage, "color_contrast must not be negative");
}

}  // namespace parkade
