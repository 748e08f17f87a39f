#pragma once

namespace parkade {

/// What counts as a line of paint, and how FindPaintLines looks for it.
struct PaintLineOptions {
  double pixel_size = 0.025;   ///< [m] at which lines are looked for
  double stripe_width = 0.12;  ///< [m] of the stripes that answer most
  double filter_length = 0.6;  ///< [m] along which brightness is averaged: more finds fainter, not shorter lines
  double min_contrast = 0.06;  ///< against both sides, of their brightness
  double min_length = 0.6;     ///< [m] of a line
  double max_gap = 0.6;        ///< [m] that a line may be interrupted
  int max_directions = 4;      ///< that one neighbourhood may have

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("pixel_size", pixel_size);
    visit("stripe_width", stripe_width);
    visit("filter_length", filter_length);
    visit("min_contrast", min_contrast);
    visit("min_length", min_length);
    visit("max_gap", max_gap);
    visit("max_directions", max_directions);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
