#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "core/triangle_mesh.h"

namespace parkade {

/// [%] of the area of a mesh at which its height is off by more than two of its sigmas: 5 where
/// sigmas are right. `true_height` [m] is that at a point of the mesh; nothing where none counts. 0
/// without sigmas. Looks every 0.2 m.
double PercentBeyondTwoSigmas(
    const TriangleMesh& mesh,
    const std::function<std::optional<double>(const Eigen::Vector3d&)>& true_height);

}  // namespace parkade
