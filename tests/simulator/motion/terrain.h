#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace parkade::simulator {

/// Height of the drivable ground over the plane: gentle drainage slopes, smooth
/// to any order so that pose, IMU and surface truth agree. World: z up, meters.
class Terrain {
 public:
  /// `relief` scales all slopes; 0 is flat, 1 about 1-2 %.
  Terrain(std::uint64_t seed, double relief);

  double Height(double x, double y) const;
  Eigen::Vector2d Gradient(double x, double y) const;

  /// Unit normal, pointing up.
  Eigen::Vector3d Normal(double x, double y) const;

 private:
  struct Wave {
    Eigen::Vector2d wave_vector;  ///< [rad/m]
    double amplitude = 0;         ///< [m]
    double phase = 0;
  };
  Eigen::Vector2d slope_;
  std::array<Wave, 4> waves_;
};

}  // namespace parkade::simulator
