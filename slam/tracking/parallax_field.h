#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace parkade {

/// Parallax = length of the camera's step / range to the point: how much a
/// bearing moves beyond rotation, without knowing any length in meters.
///
/// \return the parallax, by the range before the step, of a point seen at
///     `turned` (its bearing before, turned into the camera after) and then at
///     `now`; `direction` as in EpipolarCheck. At least 0.
double ParallaxOf(const Eigen::Vector3d& turned, const Eigen::Vector3d& now,
                  const Eigen::Vector3d& direction);

/// Parallaxes known at some bearings, continued to others: where roads and walls
/// are seen, neighbors lie on one plane, and on a plane the parallax is linear
/// in the bearing.
class ParallaxField {
 public:
  void Add(const Eigen::Vector3d& bearing, double parallax) {
    samples_.push_back({bearing, parallax});
  }

  /// Local plane through the nearest samples; nothing while there are fewer than 6.
  std::optional<double> At(const Eigen::Vector3d& bearing) const;

 private:
  struct Sample {
    Eigen::Vector3d bearing;
    double parallax = 0;
  };

  std::vector<Sample> samples_;
};

}  // namespace parkade
