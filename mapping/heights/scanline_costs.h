#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace parkade {

/// A window of a grid. Windows side by side whose heights [m] differ by a meter are on different
/// decks and no neighbors.
struct GridPlace {
  int x = 0, y = 0;
  double height = 0;
};

/// What it costs, in nats, that two windows side by side differ by a number of steps of the sweep:
/// in proportion, so that a step at one place costs no more than the same rise over several.
struct StepPenalties {
  float per_step = 1.2F;
  float most = 4;  ///< however far apart: there is an edge
};

/// What each window costs at each height once those around it have had their say: along eight
/// directions costs are summed up from window to window as a Viterbi decoder does, and what the
/// window itself says counts once. Steps survive, since penalties are bounded.
/// H. Hirschmueller, "Stereo processing by semiglobal matching and mutual information", PAMI 2008;
/// A. Drory et al., "Semi-global matching: a principled derivation in terms of message passing",
/// GCPR 2014.
/// \param places  sorted by y and x
/// \param costs   [nats] places.size() x num_heights, row by row
/// \return the same shape; the least of a row is 0
std::vector<float> SumAlongScanlines(std::span<const GridPlace> places,
                                     std::span<const float> costs, std::size_t num_heights,
                                     const StepPenalties& penalties);

}  // namespace parkade
