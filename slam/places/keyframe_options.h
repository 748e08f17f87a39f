#pragma once

#include "core/option_about.h"

namespace parkade {

struct KeyframeOptions {
  double spacing = 2;             ///< [m] between keyframes
  double spacing_deg = 25;        ///< a turn of this much makes a keyframe too
  int max_features = 400;         ///< kept per image
  double max_distance = 40;       ///< [m] of points that are believed
  double max_depth_error = 0.15;  ///< sigma / distance above which a point is not believed

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("spacing", spacing,
          OptionAbout{"The rig's keyframes lie this far apart along the drive.", "m", 0.5, 20});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
