#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/surface_map.h"

namespace parkade {

/// Triangles over the height field of a surface, before attributes.
struct HeightMesh {
  std::vector<Eigen::Vector3d> vertices;                ///< [m] in site
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from above
};

/// Two triangles for each square of four neighboring cells of one deck; a vertex is the center of a
/// cell at its height. Vertices where only corners touch are doubled: the result is a manifold with
/// borders. \param max_step  [m] of height between linked neighbors \param min_belief  triangles
/// are cut where the belief, linear between cells, falls below; 0: nothing is cut
HeightMesh TriangulateHeights(const SurfaceMap& surface, double max_step, double min_belief = 0);

/// Doubles each vertex around which triangles form several groups that share no edge. The copies
/// are appended in order of the vertex they copy; returned is, for each copy, that vertex.
std::vector<std::uint32_t> DuplicateNonManifoldVertices(HeightMesh& mesh);

}  // namespace parkade
