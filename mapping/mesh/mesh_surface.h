#pragma once

#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "mapping/mesh/mesh_options.h"

namespace parkade {

/// The drivable part of a surface as a mesh: voxels around the free cells hold the signed height
/// above the ground, marching cubes takes the zero level, its outline is cut where the belief
/// interpolated between cells passes the threshold, CGAL merges what is flat and of one color. Each
/// deck is a sheet of its own. In memory are the cells, voxels and triangles of one window, and
/// what simplifying leaves of all; the result does not depend on the windows. Without simplifying
/// all are. Passes ValidateMesh; every edge has one or two triangles, every vertex one fan. Empty
/// where nothing is free. Deterministic.
TriangleMesh MeshSurface(const SurfaceMap& surface, const MeshOptions& options = {});

}  // namespace parkade
