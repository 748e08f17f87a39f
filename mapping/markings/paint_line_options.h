#pragma once

namespace parkade {

/// What counts as a line of paint, and how FindPaintLines looks for it.
struct PaintLineOptions {
  double pixel_size = 0.025;   ///< [m] at which lines are looked for
  double stripe_width = 0.12;  ///< [m] of the stripes that answer most
  double filter_length =
      0.6;  ///< [m] along which brightness is averaged: more finds fainter, not shorter lines
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
