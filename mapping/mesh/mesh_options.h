#pragma once

namespace parkade {

/// How a surface becomes a mesh.
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

}  // namespace parkade
