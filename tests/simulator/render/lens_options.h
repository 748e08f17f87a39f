#pragma once

#include "core/error.h"

namespace parkade::simulator {

/// What spoils images before they reach the sensor, all along the drive.
struct LensOptions {
  double dirt = 0;   ///< 0 clean to 1: specks, smears and dried drops on a third of the lens
  double flare = 0;  ///< of the sun: 0 none, 1 as of an old fisheye: a veil and ghosts

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("dirt", dirt);
    visit("flare", flare);
  }
  void Validate() const {  ///< throws Error{kUsage}
    Require(dirt >= 0 && dirt <= 1, ErrorCode::kUsage, "the dirt must be 0 to 1");
    Require(flare >= 0 && flare <= 2, ErrorCode::kUsage, "the flare must be 0 to 2");
  }
};

}  // namespace parkade::simulator
