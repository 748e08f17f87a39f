#pragma once

#include "core/surface_map.h"
#include "core/triangle_mesh.h"

namespace parkade {

struct MeshOptions {
  int cells_per_voxel = 2;         ///< cells of the surface on each side of a voxel; more is coarser and smaller
  double voxel_height = 0.25;      ///< [m]; has no influence on accuracy, only on slivers on slopes
  double free_threshold = 0.5;     ///< belief from which a cell is drivable
  double max_step = 0.3;           ///< [m] between neighbours of one deck; steeper is a gap
  bool simplify = true;            ///< merges flat triangles of one colour
  double max_height_error = 0.01;  ///< [m] that simplifying may cost
  int color_contrast = 40;         ///< edges between colours further apart (of 255) are kept
  double window_size = 48.0;       ///< [m] of the squares that are meshed one after the other; less takes less memory

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("cells_per_voxel", cells_per_voxel);
    visit("voxel_height", voxel_height);
    visit("free_threshold", free_threshold);
    visit("max_step", max_step);
    visit("simplify", simplify);
    visit("max_height_error", max_height_error);
    visit("color_contrast", color_contrast);
    visit("window_size", window_size);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// The drivable part of a surface as a mesh: voxels around the free cells hold the signed height above the
/// ground, marching cubes takes the zero level, its outline is cut where the belief interpolated between cells passes
/// the threshold, CGAL merges what is flat and of one colour. Each deck is a sheet
/// of its own. In memory are the cells, voxels and triangles of one window, and what simplifying leaves of all; the
/// result does not depend on the windows. Without simplifying all are. Passes ValidateMesh; every edge has one or two
/// triangles, every vertex one fan. Empty where nothing is free. Deterministic.
TriangleMesh MeshSurface(const SurfaceMap& surface, const MeshOptions& options = {});

}  // namespace parkade
