#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace parkade {

/// Share of the distance between new corners (CornerDetector::min_distance) below which one of two
/// tracks ends: they converge.
inline constexpr double kCrowded = 0.5;

/// Indices, in order, of the `pixels` that are at least `distance` [px] from every one kept before.
/// O(n^2).
std::vector<size_t> SuppressNonMaxima(const std::vector<Eigen::Vector2d>& pixels, double distance);

}  // namespace parkade
