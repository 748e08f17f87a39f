#pragma once

#include <Eigen/Core>
#include <vector>

namespace parkade::simulator {

/// A path in the plane whose curvature is continuous: a polyline with rounded
/// corners, smoothed along its length. It carries a hint of the height along, which tells decks of
/// a garage apart.
class Route {
 public:
  /// `waypoints` are x, y and the hint [m]. Rounds each corner by an arc of `radius` [m], slight
  /// bends by six times that, as far as half the adjoining sides allow; of the first and the last
  /// side all but a straight end. Throws Error{kInternal} for fewer than two points.
  Route(const std::vector<Eigen::Vector3d>& waypoints, double radius);

  /// What lies between two distances [m] from the start, clamped to the ends; at least a few
  /// centimeters.
  Route Part(double from, double to) const;

  double Length() const { return step_ * static_cast<double>(points_.size() - 1); }  ///< [m]

  // At `distance` [m] from the start, clamped to the ends.
  Eigen::Vector2d Position(double distance) const;
  double HeightHint(double distance) const;        ///< [m]
  double Heading(double distance) const;           ///< [rad], continuous (not wrapped)
  Eigen::Vector3d PointAt(double distance) const;  ///< position and hint

  /// [1/m]
  double Curvature(double distance) const;

 private:
  double Interpolate(const std::vector<double>& values, double distance) const;

  double step_ = 0.01;  ///< [m] between points_, in the plane
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> headings_;
};

}  // namespace parkade::simulator
