#pragma once

#include <Eigen/Core>
#include <vector>

#include "tests/simulator/common/color.h"

namespace parkade::simulator {

/// A lamp that shines downwards from a point: irradiance square to its light is
/// intensity * (0.25 + 0.75 cos(angle to straight down)) / distance^2.
struct Lamp {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< [m] world
  Color intensity = Gray(1);
};

/// The lamps of a scene, quick to find by place.
class LampField {
 public:
  static constexpr float kReach = 14;  ///< [m] beyond it a lamp gives no light

  LampField() = default;
  explicit LampField(std::vector<Lamp> lamps);

  bool empty() const { return lamps_.empty(); }

  /// The lamps that may light a point of the world, by index.
  const std::vector<std::uint32_t>& Near(const Eigen::Vector3f& point) const;
  const std::vector<Lamp>& lamps() const { return lamps_; }

  /// Irradiance of one lamp at a surface, as if nothing stood between.
  static Color Irradiance(const Lamp& lamp, const Eigen::Vector3f& point,
                          const Eigen::Vector3f& normal);

  /// The light of all lamps near the point, as if nothing stood between.
  Color Irradiance(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;

 private:
  static constexpr float kCell = 4;  ///< [m]
  std::vector<Lamp> lamps_;
  Eigen::Vector3f min_ = Eigen::Vector3f::Zero();
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace parkade::simulator
