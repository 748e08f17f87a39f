#pragma once

#include <string>

#include "core/site_map.h"
#include "export/gltf/mesh_encoding.h"

namespace parkade {

/// A small two-deck garage: a lower deck of 40 m x 20 m with a pillar, a ramp of 12 % and an upper
/// deck above the lower one's east half; two drives over both decks whose odometry drifts. The mesh
/// is that of the surface.
SiteMap MakeExampleMap(bool is_georeferenced);

/// [m] from the lower deck to the top of the ramp.
inline constexpr double kUpperDeckHeight = 2.6;

/// The same with a texture: a chart for each 16 m square of triangles' centers and each deck,
/// texels of 0.1 m whose red is the column and whose green is the row, of 255, across an image of
/// 50 m x 30 m from (-25, 15).
SiteMap MakeTexturedMap();

/// Two drives and no ground.
SiteMap MakeMapWithoutGround();

/// No drives; triangles that are no manifold: three at one edge, and two that meet in a vertex
/// only.
SiteMap MakeMapOfNoManifold();

/// What WriteGltf writes.
std::string EncodeGltf(const SiteMap& map, MeshEncoding encoding);

}  // namespace parkade
