#pragma once

namespace parkade {

/// How MeasureHeights sweeps the ground, and what it believes.
struct MeasureHeightsOptions {
  int num_rounds = 4;      ///< 0: the height of the ground beside the path is extrapolated only
  double window = 1.2;     ///< [m] side of the squares of ground that get a height each
  double cell_size = 0.1;  ///< [m] of the image of the ground in a window
  double max_offset =
      0.25;            ///< [m] above and below what is known so far; half of it in the last round
  int num_steps = 16;  ///< to each side
  double max_distance = 16.0;  ///< [m] of ground to a camera
  int max_views =
      400;  ///< of a tile of twelve windows: of more, an even selection; half in early rounds
  double min_contrast = 1.5;  ///< [gray values] of the ground in a window, rms; less shows nothing
  double min_observations = 1.5;  ///< of a cell of a window on average: less agrees by chance
  double max_jump = 0.03;         ///< [m] of correction between windows side by side
  double sigma = 0.01;            ///< [m] at best
  void Validate() const;          ///< throws Error{kUsage}
};

}  // namespace parkade
