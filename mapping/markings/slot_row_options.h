#pragma once

#include "core/option_about.h"

namespace parkade {

/// What a slot of one kind may measure.
struct SlotMeasures {
  double min_pitch = 2.1, max_pitch = 3.4;    ///< [m] from line to line, square to them
  double min_length = 4.0, max_length = 6.3;  ///< [m] of a slot along its lines
  double usual_length = 5.0;  ///< [m] where only one end of the lines is seen anywhere

  /// [m] of a line between slots, of which two may stand behind each other; what is longer bounds
  /// something else.
  double LongestLine() const { return 2 * max_length; }
  void Validate() const;  ///< throws Error{kUsage}
};

/// What counts as a row of slots.
struct SlotRowOptions {
  SlotMeasures beside;  ///< perpendicular and angled ones
  SlotMeasures behind{4.6, 7.4, 1.6, 2.9,
                      2.0};  ///< parallel ones: their lines are short and far apart
  int max_missing = 2;       ///< lines that may be hidden or worn off in a row
  double min_confidence = 0.32;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("min_confidence", min_confidence,
          OptionAbout{"A slot is kept from this confidence on.", "", 0, 1});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
