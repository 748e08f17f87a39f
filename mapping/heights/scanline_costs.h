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

/// What each window of chains costs at each height once those before and after it have had their
/// say: the least that any heights of the others make of all costs and penalties of its chain.
/// \param before  the number of the window before each one, less than its own, or -1
/// \param costs   [nats] before.size() x num_heights, row by row; the result has the same shape
std::vector<float> SumAlongChains(std::span<const int> before, std::span<const float> costs,
                                  std::size_t num_heights, const StepPenalties& penalties);

/// Subtracts from each row its least cost.
void SubtractLeast(std::span<float> costs, std::size_t num_heights);

/// Mean and deviation [m] of a height whose costs are given.
struct HeightBelief {
  double mean = 0, sigma = 0;
};
HeightBelief BeliefOf(std::span<const float> costs, std::span<const float> heights);

/// [nats] by which costs tell heights apart.
float EvidenceOf(std::span<const float> costs);

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
