#pragma once

#include <filesystem>

#include "core/triangle_mesh.h"

namespace parkade {

/// A triangle mesh from a PLY file, ascii or binary little-endian: vertices x y z with or without
/// normals (nx ny nz), colors (red green blue) and height_sigma; faces with vertex_indices or
/// vertex_index, polygons are cut into triangles. What else is in the file is skipped. A header
/// line `comment origin X Y Z` is added to the vertices. Missing normals are worked out, missing
/// colors are gray. Throws Error{kNotFound}, Error{kInvalidInput} naming the file and what is wrong
/// with it; memory is bounded by the file's size whatever its header claims.
TriangleMesh ReadPly(const std::filesystem::path& file);

}  // namespace parkade
