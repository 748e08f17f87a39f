#pragma once

namespace parkade {

/// What counts as a line of paint, and how FindPaintLines looks for it.
struct PaintLineOptions {
  double pixel_size = 0.025;   ///< [m] at which lines are looked for
  double stripe_width = 0.12;  ///< [m] of the stripes that answer most
  double filter_length =
      0.6;  ///< [m] along which brightness is averaged: more finds fainter, not shorter lines
  double min_contrast = 0.06;  ///< against both sides, of their brightness
  double min_length = 0.6;     ///< [m] of a line
  double max_gap = 0.6;        ///< [m] that a line may be interrupted
  int max_directions = 4;      ///< that one neighborhood may have
  void Validate() const;       ///< throws Error{kUsage}
};

}  // namespace parkade
