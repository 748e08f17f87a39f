#include "slam/refinement/refinement_options.h"

#include "core/error.h"

namespace parkade {

void RefinementOptions::Validate() const {
  Require(bearings_per_image > 0 && min_observations >= 3 && max_iterations > 0 &&
              max_nodes >= 100 && piece_nodes >= 100 && min_nodes >= 3 &&
              observations_per_track >= min_observations,
          ErrorCode::kUsage,
          "the counts of the refinement must be positive, with at least 3 observations, 100 nodes, "
          "and tracks not thinned "
          "below that");
  Require(bearing_inflation > 0 && max_imu_growth > 0 && max_held_out_growth > 0 &&
              max_track_growth > 0,
          ErrorCode::kUsage, "the bounds of the refinement must be positive");
  Require(
      held_out_share >= 0 && held_out_share < 1, ErrorCode::kUsage,
      "the share of tracks and loops that the refinement holds out must be at least 0 and below 1");
}

}  // namespace parkade
