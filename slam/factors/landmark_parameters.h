#pragma once

#include <Eigen/Core>

namespace parkade {

/// A landmark is 3 parameters [a, b, inverse distance] around a fixed ray in
/// odom: point = origin + (direction + basis [a b]^T) / inverse_distance. Points
/// at infinity are ordinary (inverse distance 0), which is why it is not xyz.
/// The origin (where it was first seen from) is a constant, not a state: an
/// observation then involves its own image's nodes only.
/// J. Civera et al., "Inverse Depth Parametrization for Monocular SLAM", TRO 2008.
inline constexpr int kLandmarkSize = 3;

struct LandmarkRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< [m] in odom
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, in odom
  Eigen::Matrix<double, 3, 2> basis;                     ///< orthonormal, across the direction

  LandmarkRay() : LandmarkRay(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX()) {}
  LandmarkRay(const Eigen::Vector3d& origin_in_odom, const Eigen::Vector3d& direction_in_odom);

  /// direction + basis [a b]^T.
  Eigen::Vector3d Ray(const double* landmark) const {
    return direction + basis.col(0) * landmark[0] + basis.col(1) * landmark[1];
  }
  /// [m] in odom; needs a positive inverse distance.
  Eigen::Vector3d Point(const double* landmark) const {
    return origin + Ray(landmark) / landmark[2];
  }
};

/// Gives a landmark that moved far from its ray a new one, through the same point.
void Rebase(LandmarkRay& ray, double* landmark);

/// Two unit vectors that complete `direction` (unit) to an orthonormal frame.
Eigen::Matrix<double, 3, 2> BasisAcross(const Eigen::Vector3d& direction);

}  // namespace parkade
