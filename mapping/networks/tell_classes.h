#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/surface_class.h"

namespace parkade {

/// Scores of a row of pixels, by class.
using ClassScores = std::array<const float*, kNumSurfaceClasses>;

/// Fills in each pixel's likeliest class, the first of those that are as likely, and the log-odds
/// of classes for cars (IsForCars) against the others, each by its softmax divided by how much it
/// is overrated. Off what std::exp and std::log give by 2e-6, or as much of it; scores 55 below the
/// best count as so much. Pixels with a score that is not finite get log-odds of 0. The same on all
/// processors.
void TellClasses(const ClassScores& scores, const std::array<float, kNumSurfaceClasses>& overrated,
                 std::span<std::uint8_t> classes, float* log_odds);

}  // namespace parkade
