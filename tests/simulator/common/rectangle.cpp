#include "tests/simulator/common/rectangle.h"

#include <algorithm>
#include <cmath>

namespace parkade::simulator {

double Rectangle::SignedDistance(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d offset = point - center;
  const double c = std::cos(yaw), s = std::sin(yaw);
  const Eigen::Vector2d local(c * offset.x() + s * offset.y(), -s * offset.x() + c * offset.y());
  const Eigen::Vector2d excess = local.cwiseAbs() - half_size;
  return excess.cwiseMax(0.0).norm() + std::min(0.0, excess.maxCoeff());
}

Eigen::Vector2d Rectangle::Corner(int index) const {
  const Eigen::Vector2d local(index == 1 || index == 2 ? half_size.x() : -half_size.x(),
                              index >= 2 ? half_size.y() : -half_size.y());
  const double c = std::cos(yaw), s = std::sin(yaw);
  return center + Eigen::Vector2d(c * local.x() - s * local.y(), s * local.x() + c * local.y());
}

}  // namespace parkade::simulator
