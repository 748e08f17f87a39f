#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>

#include "core/ground_markings.h"

namespace parkade {

/// A slot in the plane, before anything is known of who stands in it.
struct PlanarSlot {
  std::array<Eigen::Vector2d, 4> corners;  ///< [m] in site, counter-clockwise
  double height = 0;                       ///< [m] in site, of the lines of its row
  SlotKind kind = SlotKind::kPerpendicular;
  double angle = 0;       ///< [rad] as ParkingSlot
  double confidence = 0;  ///< 0 to 1
  int num_marked_sides = 0;
};

/// Whether the cameras saw bare ground at a place [m] on the deck of a height [m]; empty: nothing
/// is known of that.
using IsBareGround = std::function<bool(const Eigen::Vector2d& place, double height)>;

}  // namespace parkade
