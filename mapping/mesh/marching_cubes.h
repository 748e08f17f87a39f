#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace parkade {

/// Corner k of a voxel is at x = k & 1, y = k >> 1 & 1, z = k >> 2 & 1. An edge joins corners a < b
/// that differ in one bit.
struct VoxelEdge {
  std::uint8_t a = 0, b = 0;
};

/// The surface through one voxel: triangles as three edges each, counter-clockwise seen from the
/// side of the corners that are outside.
using VoxelTriangles = std::vector<std::array<VoxelEdge, 3>>;

/// For each of the 256 ways in which a voxel's corners lie inside (bit k set: corner k is inside).
/// Worked out from the voxel's faces instead of typed in: on each face a segment leads from where
/// the outline leaves the inside to where it enters again; segments of all faces chain to loops.
/// Adjacent voxels agree on ambiguous faces. W. Lorensen, H. Cline, "Marching Cubes: A High
/// Resolution 3D Surface Construction Algorithm", SIGGRAPH 1987.
const std::array<VoxelTriangles, 256>& MarchingCubesCases();

}  // namespace parkade
