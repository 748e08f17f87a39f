#include "slam/tracking/feature_tracker_options.h"

#include "core/error.h"
#include "slam/tracking/flow_patch.h"

namespace parkade {

void FeatureTrackerOptions::Validate() const {
  Require(max_tracks >= 8 && max_tracks <= 5000, ErrorCode::kUsage,
          "max_tracks must be in 8..5000");
  Require(window >= 5 && window <= FlowPatch::kMaxEdge && window % 2 == 1, ErrorCode::kUsage,
          "window must be odd and in 5..21 px");
  Require(pyramid_levels >= 1 && pyramid_levels <= 8, ErrorCode::kUsage,
          "pyramid_levels must be in 1..8");
  Require(pixel_sigma > 0, ErrorCode::kUsage, "pixel_sigma must be > 0 px");
  Require(max_round_trip > 0, ErrorCode::kUsage, "max_round_trip must be > 0 px");
  Require(max_epipolar_error > 0, ErrorCode::kUsage, "max_epipolar_error must be > 0 px");
  Require(max_gap > 0, ErrorCode::kUsage, "max_gap must be > 0 s");
}

}  // namespace parkade
