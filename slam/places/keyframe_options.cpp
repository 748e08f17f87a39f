#include "slam/places/keyframe_options.h"

#include "core/error.h"

namespace parkade {

void KeyframeOptions::Validate() const {
  Require(spacing > 0 && spacing_deg > 0 && max_distance > 0 && max_depth_error > 0,
          ErrorCode::kUsage, "the options of places must be positive");
  Require(max_features >= 10 && max_features <= 10000, ErrorCode::kUsage,
          "max_features of places must be 10 to 10000");
}

}  // namespace parkade
