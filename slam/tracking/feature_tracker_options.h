#pragma once

#include "core/option_about.h"

namespace parkade {

struct FeatureTrackerOptions {
  int max_tracks = 180;    ///< per image; also sets the distance between corners
  int window = 17;         ///< [px] odd edge of the patch that is tracked; larger: steadier, slower
  int pyramid_levels = 4;  ///< halvings + 1; more: larger motion than the gyro predicts
  double pixel_sigma = 0.5;         ///< [px] noise reported with each observation
  double max_round_trip = 0.7;      ///< [px] forward-backward error above which a track ends
  double max_epipolar_error = 1.5;  ///< [px] off the epipolar plane above which a track ends
  double max_gap = 1.0;             ///< [s] tracks do not survive a longer pause
  bool learn_own_body = true;       ///< find and ignore the car's own body in the image

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("max_tracks", max_tracks,
          OptionAbout{"Each camera follows this many corners at most, and more than three cameras "
                      "together as many as three.",
                      "", 20, 2000});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
