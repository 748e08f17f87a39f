#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "core/triangle_mesh.h"
#include "mapping/evaluation/evaluate_surface.h"

namespace parkade {

/// Truth and estimate from above around the path [m], 5 cm per pixel: gray is right, red false,
/// blue missed, dark truth that nothing saw.
void WriteOutlineImage(const TriangleMesh& truth, const TriangleMesh& estimate,
                       const std::vector<Eigen::Vector3d>& path, const SurfaceScope& scope,
                       const std::filesystem::path& file);

/// Height of the estimate minus that of the truth, also: blue is 10 cm too low or more, gray right,
/// red 10 cm too high; black what the estimate lacks.
void WriteHeightImage(const TriangleMesh& truth, const TriangleMesh& estimate,
                      const std::vector<Eigen::Vector3d>& path, const std::filesystem::path& file);

}  // namespace parkade
