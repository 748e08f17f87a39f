#pragma once

#include <string>

#include "core/triangle_mesh.h"

namespace parkade {

/// Binary little-endian PLY in the site frame, z up: vertices x y z nx ny nz [m, float], red green
/// blue, height_sigma [m], surface (SurfaceClass); faces as vertex_indices.
std::string EncodePly(const TriangleMesh& mesh);

}  // namespace parkade
