#include "slam/sessions/session_loop.h"

#include "core/error.h"

namespace parkade {

void SessionLoopOptions::Validate() const {
  Require(max_candidates > 0 && batch > 0 && max_measured > 0 && min_links > 0 && neighbors >= 0 &&
              neighbors <= 10,
          ErrorCode::kUsage,
          "counts of links between drives must be positive, and at most 10 neighbors");
  Require(min_spread >= 0 && max_rival_share >= 0 && reach > 0 && height_reach > 0 &&
              closing_base > 0 && closing_per_meter >= 0 && closing_deg > 0,
          ErrorCode::kUsage, "the bounds on links between drives must be positive");
  Require(min_floor_tiles >= 1 && telling_floor > 0 && telling_floor <= 1 && min_floor_share >= 0 &&
              min_floor_share < 1,
          ErrorCode::kUsage,
          "what floors must show to tell places apart must be shares of at least one tile");
  Require(all_pairs_up_to >= 2 && partners >= 1, ErrorCode::kUsage,
          "links.all_pairs_up_to must be at least 2, links.partners at least 1");
}

}  // namespace parkade
