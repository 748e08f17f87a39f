#pragma once

#include <Eigen/Core>

namespace parkade::simulator {

/// A rectangle in the plane, turned by `yaw`.
struct Rectangle {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();     ///< [m]
  Eigen::Vector2d half_size = Eigen::Vector2d::Zero();  ///< [m] along its own x and y
  double yaw = 0;

  bool Contains(const Eigen::Vector2d& point) const {
    return (point - center).squaredNorm() <= half_size.squaredNorm() && SignedDistance(point) <= 0;
  }
  /// [m] to the border, negative inside.
  double SignedDistance(const Eigen::Vector2d& point) const;
  Eigen::Vector2d Corner(int index) const;  ///< 0..3, counter-clockwise from (-, -)
};

}  // namespace parkade::simulator
