#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace parkade {

/// A ray in odom along which a point was seen.
struct ObservationRay {
  Eigen::Vector3d origin;     ///< [m]
  Eigen::Vector3d direction;  ///< unit
  double sigma = 1e-3;        ///< [rad]
};

struct Triangulated {
  double inverse_distance = 0;  ///< [1/m] along the first ray; 0 = no parallax yet
  double parallax = 0;          ///< [rad] largest angle between two rays
};

/// The point nearest to all rays, in angle. Nothing when rays contradict each other
/// by more than `max_error` standard deviations, or the point lies behind a ray
/// or nearer than `min_distance` [m]. Rays without measurable parallax give
/// inverse distance 0.
std::optional<Triangulated> Triangulate(std::span<const ObservationRay> rays, double max_error,
                                        double min_distance);

}  // namespace parkade
