#pragma once

#include <vector>

#include "tests/simulator/motion/route.h"

namespace parkade::simulator {

/// A stretch that is driven in one direction.
struct Leg {
  Route route;  ///< in the order in which it is driven
  bool is_reverse = false;
};

/// Where the body is on the plane, and how it turns.
struct PathPoint {
  Eigen::Vector2d position;
  double near_z = 0;     ///< [m] hint of the height
  double heading = 0;    ///< [rad] of the body, continuous along the path
  double curvature = 0;  ///< [1/m] turn of the body to the left per meter that it goes forward
};

/// What the rear axle drives along: legs, each of which begins where the one before ends. Where the
/// direction changes, both legs are straight and in line.
class DrivePath {
 public:
  /// At least one leg.
  explicit DrivePath(std::vector<Leg> legs);

  const std::vector<Leg>& legs() const { return legs_; }
  double Length() const;     ///< [m] forward and backward together
  double MinRadius() const;  ///< [m]

  /// `distance` [m] from the start of a leg.
  PathPoint At(size_t leg, double distance) const;

 private:
  std::vector<Leg> legs_;
  std::vector<double> turns_;  ///< [rad] from each route's heading to the body's
};

}  // namespace parkade::simulator
