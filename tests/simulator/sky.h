#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tests/simulator/color.h"

namespace parkade::simulator {

/// Daylight: one sun and a sky with thin clouds, infinitely far away.
class Sky {
 public:
  /// The sun stands where the seed wants it, 30-55 degrees high.
  explicit Sky(std::uint64_t seed);

  const Eigen::Vector3f& sun_direction() const { return sun_direction_; }  ///< unit, towards the sun, world
  const Color& sun_irradiance() const { return sun_irradiance_; }          ///< on a surface square to it
  static constexpr float kSunRadius = 0.0047f;                             ///< [rad]

  /// Radiance from a direction (unit, world), sun disc included.
  Color Radiance(const Eigen::Vector3f& direction) const;

  /// Mean radiance near the horizon: what distance fades to.
  const Color& haze() const { return haze_; }

  /// Light of sky and of the sunlit surroundings on an unshaded surface.
  Color AmbientIrradiance(const Eigen::Vector3f& normal) const;

 private:
  Color Paint(const Eigen::Vector3f& direction, std::uint32_t seed) const;

  Eigen::Vector3f sun_direction_;
  Color sun_irradiance_, haze_, zenith_, from_above_, from_below_;
  std::vector<Color> map_;  ///< rows of elevation from the horizon up, columns of azimuth
};

}  // namespace parkade::simulator
