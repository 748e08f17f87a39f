#pragma once

#include "slam/factors/bearing_cost.h"
#include "slam/refinement/drive_adjustment.h"

namespace parkade {

// What DriveAdjustment is made of; for its own source files only.

/// Where a track was seen: image and keyframe among its observations.
struct DriveAdjustment::Seen {
  std::uint32_t image = 0, observation = 0;
};

struct DriveAdjustment::LandmarkObservation {
  size_t image = 0;
  Bearing bearing;
  std::unique_ptr<BearingCost> cost;
};

struct DriveAdjustment::Landmark {
  LandmarkRay ray;
  double* values = nullptr;
  std::vector<LandmarkObservation> observations;
  bool is_used = true;  ///< false: held out, it shows how good the poses are
};

}  // namespace parkade
