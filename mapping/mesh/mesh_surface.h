#pragma once

#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "mapping/mesh/mesh_options.h"

namespace parkade {

/// The drivable part of a surface as a mesh: two triangles for each square between four cells,
/// cut where the belief interpolated between cells passes the threshold; CGAL merges what is flat
/// and of one color. Decks are not joined. In memory are the cells and triangles of one window, and
/// what simplifying leaves of all; the result does not depend on the windows. Without simplifying
/// all are. Passes ValidateMesh; every edge has one or two triangles, and around every
/// vertex they follow each other. Empty
/// where nothing is free. Deterministic.
TriangleMesh MeshSurface(const SurfaceMap& surface, const MeshOptions& options = {});

}  // namespace parkade
