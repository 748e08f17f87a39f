#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace parkade {

/// [rad] heading of the x axis turned by a rotation, about z, from x toward y; in [-pi, pi].
inline double YawOf(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d x = rotation * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

}  // namespace parkade
