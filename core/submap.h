#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/rigid3.h"
#include "core/timestamp.h"

namespace parkade {

/// A moment worth keeping: one image of one camera.
struct Keyframe {
  Timestamp time;
  int camera = 0;
  Rigid3 submap_from_body;
};

/// A point that odometry triangulated.
struct Landmark {
  Eigen::Vector3d point_in_submap;  ///< [m]
  double sigma = 0;                 ///< [m] along the worst direction
  int num_observations = 0;
};

/// A stretch of one drive. Immutable once cut.
struct Submap {
  int drive = 0;  ///< index into the drives of the site
  Rigid3 odom_from_submap;
  std::vector<Keyframe> keyframes;  ///< in order of time
  std::vector<Landmark> landmarks;
};

/// The only number a loop or a merge changes.
struct PosedSubmap {
  Submap submap;
  Rigid3 site_from_submap;
};

}  // namespace parkade
