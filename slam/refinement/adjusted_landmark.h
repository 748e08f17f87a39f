#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "slam/factors/bearing_cost.h"
#include "slam/factors/landmark_parameters.h"

namespace parkade {

/// Where a track was seen: the image, and which of its observations.
struct SeenTrack {
  std::uint32_t image = 0, observation = 0;
};

/// A bearing of a landmark in one image of DriveAdjustment.
struct LandmarkObservation {
  size_t image = 0;
  Bearing bearing;
  std::unique_ptr<BearingCost> cost;
};

/// A landmark of DriveAdjustment.
struct AdjustedLandmark {
  LandmarkRay ray;
  double* values = nullptr;
  std::vector<LandmarkObservation> observations;
  bool is_used = true;  ///< false: held out, it shows how good the poses are
};

}  // namespace parkade
