#pragma once

#include "core/option_about.h"

namespace parkade {

/// How a surface becomes a mesh.
struct MeshOptions {
  double free_threshold = 0.5;     ///< belief from which a cell is drivable
  double max_step = 0.3;           ///< [m] between neighbors of one deck; steeper is a gap
  bool simplify = true;            ///< merges flat triangles of one color
  double max_height_error = 0.01;  ///< [m] that simplifying may cost
  int color_contrast = 40;         ///< edges between colors further apart (of 255) are kept
  double window_size =
      48.0;  ///< [m] of the squares that are meshed one after the other; less takes less memory

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("max_step", max_step,
          OptionAbout{"Neighboring cells that differ by more are not joined.", "m", 0.02, 2});
    visit("max_height_error", max_height_error,
          OptionAbout{"Simplifying may move the surface by this much.", "m", 0, 0.2});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
