#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace parkade {

using Quadrilateral = std::array<Eigen::Vector2d, 4>;

/// [m^2] positive counter-clockwise.
double SignedArea(const Quadrilateral& shape);

/// [m^2] that two convex, counter-clockwise shapes have in common.
double SharedArea(const Quadrilateral& a, const Quadrilateral& b);

/// Intersection over union of two convex, counter-clockwise shapes.
double OverlapOf(const Quadrilateral& a, const Quadrilateral& b);

/// True for points inside a convex, counter-clockwise shape, at least `margin` [m] from its sides.
bool Contains(const Quadrilateral& shape, const Eigen::Vector2d& point, double margin = 0);

}  // namespace parkade
