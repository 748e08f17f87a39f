#pragma once

namespace parkade {

/// How MeasureHeights sweeps the ground, and what it believes.
struct MeasureHeightsOptions {
  double window = 1.2;         ///< [m] side of the squares of ground that get a height each
  double cell_size = 0.1;      ///< [m] of the image of the ground in a window
  int num_steps = 16;          ///< to each side
  double max_distance = 16.0;  ///< [m] of ground to a camera
  int max_views =
      400;  ///< of a tile of twelve windows: of more, an even selection; half in early rounds
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
