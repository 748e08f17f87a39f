#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace parkade {

/// Where a landmark should be seen and where it was: unit vectors in the camera.
struct DirectionPair {
  Eigen::Vector3d predicted;
  Eigen::Vector3d measured;
};

/// A rotation that takes all predictions to their measurements.
struct Turn {
  Eigen::Quaterniond measured_from_predicted = Eigen::Quaterniond::Identity();
  double angle = 0;         ///< [rad] of it
  double error_before = 0;  ///< [rad] median over the pairs
  double error_after = 0;   ///< [rad] median once turned
  double spread = 0;  ///< 1 - |mean direction| of the pairs that it explains: 0.01 is one object,
                      ///< 0.5 a whole view
};

/// Robust least squares over the pairs (Wahba's problem, reweighted); nothing for
/// too few of them.
/// K. Arun, T. Huang, S. Blostein, "Least-Squares Fitting of Two 3-D Point Sets", PAMI 1987.
std::optional<Turn> FitRotation(const std::vector<DirectionPair>& pairs);

}  // namespace parkade
