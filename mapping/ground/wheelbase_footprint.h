#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/rig.h"

namespace parkade {

/// The rectangle between a car's four wheel contacts, in the frame `ground` (z = 0 on the road,
/// origin below the rear axle, x forward): x in [0, wheelbase], |y| <= track / 2. A point where the
/// car's size is unknown.
struct WheelbaseFootprint {
  double wheelbase = 0;  ///< [m]
  double track = 0;      ///< [m]

  static WheelbaseFootprint Of(const Rig& rig) {
    return rig.vehicle ? WheelbaseFootprint{rig.vehicle->wheelbase, rig.vehicle->track}
                       : WheelbaseFootprint{};
  }

  /// [m] from a point of the road to the rectangle; 0 inside. The car knows the height of the road
  /// in here, and has to extrapolate out there.
  double DistanceTo(const Eigen::Vector2d& point_in_ground) const {
    const double dx = std::max({-point_in_ground.x(), point_in_ground.x() - wheelbase, 0.0});
    const double dy = std::max(std::abs(point_in_ground.y()) - 0.5 * track, 0.0);
    return std::hypot(dx, dy);
  }
};

}  // namespace parkade
