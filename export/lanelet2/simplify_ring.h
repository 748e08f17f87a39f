#pragma once

#include <vector>

#include "export/cell_boundary.h"

namespace parkade {

/// Fewer corners for a simple ring, counter-clockwise or clockwise: each that is left out bends to
/// the left, so that the ground on the left only loses, and lay within `tolerance` [m] of the line
/// that takes its place. The ring neither comes to cross itself nor nearer than two millimeters to
/// another of its corners. Corners that `is_fixed` stay. After M. Visvalingam and J. D. Whyatt,
/// The Cartographic Journal 30, 1993. N log N, where lines are short.
Ring LeaveOutLeftBends(const Ring& ring, double tolerance, std::vector<bool> is_fixed);

/// The same for corners that bend to the right: the ground on the left only gains.
Ring LeaveOutRightBends(const Ring& ring, double tolerance, std::vector<bool> is_fixed);

}  // namespace parkade
