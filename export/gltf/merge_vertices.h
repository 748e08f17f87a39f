#pragma once

#include <cstdint>
#include <vector>

#include "core/triangle_mesh.h"

namespace parkade {

/// For each vertex of a mesh the one that stands for all of its cube of edge `cell` [m]; the one
/// nearest to the mean of those on the outline, so that outlines stay, or of all where none is on
/// it. Cubes are at most 1 m high, so that decks stay apart. Parts of the mesh that use the same
/// vertices meet without cracks at every level of detail. J. Rossignac, P. Borrel,
/// "Multi-resolution 3D approximations for rendering complex scenes", 1993.
std::vector<std::uint32_t> MergeVertices(const TriangleMesh& mesh, double cell);

}  // namespace parkade
