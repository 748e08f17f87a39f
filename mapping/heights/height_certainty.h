#pragma once

#include <span>

#include "mapping/heights/height_field.h"

namespace parkade {

/// Observations that disagree know a height less well than the best of them says: a patch's sigma
/// grows by half of how far they scatter around the surface. Of many drives one is always very
/// sure.
void AddScatter(std::span<const HeightObservation> observations, HeightField& field);

/// Says of every patch of a field how well its height is known: where nothing measured it, the
/// surface is continued from what was, and how fast that goes wrong on this ground is learnt from
/// where both ends are known: a garage's deck goes on for as long as one sees it, a lot's slopes do
/// not. Patches that were measured, or that a keyframe's plane knows better, keep their sigma.
void SpreadSigmas(HeightField& field);

}  // namespace parkade
