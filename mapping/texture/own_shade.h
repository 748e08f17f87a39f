#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "core/rigid3.h"
#include "mapping/ground/wheelbase_footprint.h"

namespace parkade {

/// A car as what casts its shadow: a box over the wheels' contact area. One of unknown size has
/// none.
class ShadeCaster {
 public:
  /// \param margin  [m] by which the box is larger to all sides than cars are
  explicit ShadeCaster(const WheelbaseFootprint& contact, double margin = 0);

  /// Whether the car keeps the sun from a place on the ground. Both in the frame of
  /// WheelbaseFootprint; `to_sun` is a unit vector.
  bool Shades(const Eigen::Vector2d& place, const Eigen::Vector3d& to_sun) const;

 private:
  Eigen::Array3d low_ = Eigen::Array3d::Zero(), high_ = Eigen::Array3d::Zero();
};

/// How dark an image of a drive shows a place near the car.
struct ShadeSample {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< [m] in the frame of WheelbaseFootprint
  Eigen::Matrix3d ground_from_site = Eigen::Matrix3d::Identity();  ///< rotation
  float darkness = 0;  ///< log of how much brighter other images of the drive show the place
};

/// The direction from which the sun shines on a drive, a unit vector in site, as the car's own
/// shadow shows it: the one by which what the car would shade is dark and what it would not is not.
/// None where no direction explains that, as under clouds and in garages. Shadows of other things
/// stand still, and are dark in all images. O(directions x samples).
std::optional<Eigen::Vector3d> FindSun(std::span<const ShadeSample> samples,
                                       const WheelbaseFootprint& contact);

}  // namespace parkade
