#include "tests/simulator/common/lamp.h"

#include <algorithm>
#include <cmath>

namespace parkade::simulator {

LampField::LampField(std::vector<Lamp> lamps) : lamps_(std::move(lamps)) {
  if (lamps_.empty()) return;
  Eigen::Vector3f max = lamps_[0].position;
  min_ = max;
  for (const Lamp& lamp : lamps_) {
    min_ = min_.cwiseMin(lamp.position);
    max = max.cwiseMax(lamp.position);
  }
  min_.array() -= kReach;
  max.array() += kReach;
  size_ = ((max - min_) / kCell).array().ceil().cast<int>() + 1;
  cells_.resize(static_cast<size_t>(size_.prod()));
  for (int z = 0; z < size_.z(); ++z)
    for (int y = 0; y < size_.y(); ++y)
      for (int x = 0; x < size_.x(); ++x)
        for (std::uint32_t i = 0; i < lamps_.size(); ++i) {
          const Eigen::Array3f low =
              min_.array() + kCell * Eigen::Array3f(static_cast<float>(x), static_cast<float>(y),
                                                    static_cast<float>(z));
          const Eigen::Array3f place = lamps_[i].position.array();
          const float away = (low - place).max(place - low - kCell).max(0.0f).matrix().norm();
          if (away < kReach)
            cells_[static_cast<size_t>((z * size_.y() + y) * size_.x() + x)].push_back(i);
        }
}

const std::vector<std::uint32_t>& LampField::Near(const Eigen::Vector3f& point) const {
  static const std::vector<std::uint32_t> none;
  if (lamps_.empty()) return none;
  const Eigen::Array3i cell = ((point - min_) / kCell).array().floor().cast<int>();
  if ((cell < 0).any() || (cell >= size_).any()) return none;
  return cells_[static_cast<size_t>((cell.z() * size_.y() + cell.y()) * size_.x() + cell.x())];
}

Color LampField::Irradiance(const Lamp& lamp, const Eigen::Vector3f& point,
                            const Eigen::Vector3f& normal) {
  const Eigen::Vector3f to_lamp = lamp.position - point;
  const float squared = std::max(0.04f, to_lamp.squaredNorm());
  if (squared > kReach * kReach) return Gray(0);
  const float distance = std::sqrt(squared), facing = normal.dot(to_lamp) / distance;
  if (facing <= 0) return Gray(0);
  const float down = std::max(0.0f, to_lamp.z() / distance);
  const float fade = 1 - squared / (kReach * kReach);  // to nothing at the end of its reach
  return lamp.intensity * (facing * (0.25f + 0.75f * down) * fade * fade / squared);
}

Color LampField::Irradiance(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const {
  Color sum = Gray(0);
  for (const std::uint32_t index : Near(point)) sum += Irradiance(lamps_[index], point, normal);
  return sum;
}

}  // namespace parkade::simulator
