#pragma once

#include <vector>

#include "core/submap.h"
#include "slam/odometry/odometry_result.h"

namespace parkade {

struct SubmapOptions {
  double length = 50;               ///< [m] of drive per submap; a remainder below half joins the one before
  double max_landmark_sigma = 0.5;  ///< [m] landmarks less certain are left out

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("length", length);
    visit("max_landmark_sigma", max_landmark_sigma);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Cuts a drive into stretches of equal length. The frame of a submap is the
/// body at its first keyframe, levelled: z up, x along the car's heading.
/// A landmark belongs to the submap in which it was first seen.
/// Every keyframe is in exactly one submap; empty without keyframes.
std::vector<Submap> CutIntoSubmaps(const OdometryResult& odometry, int drive, const SubmapOptions& options = {});

}  // namespace parkade
