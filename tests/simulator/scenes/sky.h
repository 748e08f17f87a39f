#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tests/simulator/common/color.h"
#include "tests/simulator/layouts/place.h"

namespace parkade::simulator {

/// The light from above: one sun and a sky with clouds, infinitely far away.
class Sky {
 public:
  /// The sun stands where the seed wants it, 30-55 degrees high unless `elevation_deg` is more than
  /// 0. Clouds hide it when it is overcast or wet; at dusk it has set.
  explicit Sky(std::uint64_t seed, Weather weather = Weather::kDry, double elevation_deg = 0);

  const Eigen::Vector3f& sun_direction() const {
    return sun_direction_;
  }  ///< unit, toward the sun, world
  const Color& sun_irradiance() const {
    return sun_irradiance_;
  }                                             ///< on a surface square to it; may be 0
  static constexpr float kSunRadius = 0.0047f;  ///< [rad]

  /// Radiance from a direction (unit, world), sun disc included.
  Color Radiance(const Eigen::Vector3f& direction) const;

  /// Mean radiance near the horizon: what distance fades to.
  const Color& haze() const { return haze_; }

  /// Light of sky and of the sunlit surroundings on an unshaded surface.
  Color AmbientIrradiance(const Eigen::Vector3f& normal) const;

 private:
  void ChooseLight(Weather weather);
  Color Paint(const Eigen::Vector3f& direction, std::uint32_t seed) const;

  Eigen::Vector3f sun_direction_;
  Color sun_irradiance_, haze_, zenith_, from_above_, from_below_, glow_;
  float cloud_ = 0.62f, overcast_ = 0;  ///< brightness of clouds; 1: clouds hide the sun
  std::vector<Color> map_;  ///< rows of elevation from the horizon up, columns of azimuth
};

}  // namespace parkade::simulator
