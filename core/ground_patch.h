#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/rigid3.h"
#include "core/timestamp.h"

namespace parkade {

/// One sample of the ground as one keyframe saw it.
struct GroundSample {
  Eigen::Vector3f point_in_body;  ///< [m]
  std::uint8_t blue = 0, green = 0, red = 0;
  bool is_free = false;  ///< drivable ground; false: seen, and not ground
  float weight = 1;      ///< inverse variance of the height [1/m^2]
  float footprint = 0;   ///< [m] side of the square of ground that it stands for; 0: one cell
  float confidence = 1;  ///< of is_free, 0 to 1: the share of a sure sight's log-odds that this one counts for
};

/// What one keyframe of one camera saw of the ground. Kept in body, so that it
/// is fused again whenever poses change.
struct GroundPatch {
  int drive = 0;
  int camera = 0;
  Timestamp time;
  std::vector<GroundSample> samples;
};

/// A patch with the pose of its body in the site.
struct PosedGroundPatch {
  GroundPatch patch;
  Rigid3 site_from_body;
};

}  // namespace parkade
