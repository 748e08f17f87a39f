#pragma once

#include <vector>

#include "core/ground_markings.h"

namespace parkade {

/// Kerbs of one place are alike: those whose height is known worse than kerbs differ lean on those
/// nearby whose height is known, as far as these agree; where they contradict those, sigmas say so.
/// With nobody to lean on they stay as they are. O(kerbs squared).
void LeanOnNeighbors(std::vector<Kerb>& kerbs);

}  // namespace parkade
