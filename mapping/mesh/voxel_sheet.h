#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/surface_map.h"

namespace parkade {

/// Triangles over the cells of a surface, before attributes.
struct VoxelSheet {
  std::vector<Eigen::Vector3d> vertices;                ///< [m] in site
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from above
};

/// Marching cubes through voxels whose vertical edges stand on the centers of the cells: a voxel's
/// corner holds its signed height above the ground of that cell and deck, so that the zero level
/// passes exactly through the cells' heights. Voxels exist only around squares of four cells that
/// are all there and linked. Vertices where two fans meet are doubled: the result is a manifold
/// with borders. \param max_step  [m] of height between linked neighbors \param min_belief
/// triangles are cut where the belief, linear between cells, falls below; 0: nothing is cut
VoxelSheet ExtractSheet(const SurfaceMap& surface, double voxel_height, double max_step,
                        double min_belief = 0);

/// Doubles each vertex at which fans of triangles meet that share no edge there. The copies are
/// appended in order of the vertex they copy; returned is, for each copy, that vertex.
std::vector<std::uint32_t> SplitFans(VoxelSheet& sheet);

}  // namespace parkade
