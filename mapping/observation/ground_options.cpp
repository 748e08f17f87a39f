#include "mapping/observation/ground_options.h"

#include "core/error.h"

namespace parkade {

void GroundOptions::Validate() const {
  Require(keyframe_distance > 0, ErrorCode::kUsage, "keyframe_distance must be > 0 m");
  Require(keyframe_angle_deg > 0, ErrorCode::kUsage, "keyframe_angle_deg must be > 0");
  Require(passes >= 0, ErrorCode::kUsage, "passes must be >= 0");
  Require(method == "network" || method == "colors", ErrorCode::kUsage,
          "method must be network or colors");
  grid.Validate();
  segmentation.Validate();
}

}  // namespace parkade
