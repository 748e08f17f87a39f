#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/rigid3.h"
#include "slam/georeference/align_to_gnss.h"

namespace parkade {

/// One drive of a group whose drives are joined already, and where its own GNSS puts it.
struct GnssDrive {
  GnssAlignment alignment;                ///< all drives' in one datum
  std::vector<Eigen::Vector3d> in_odom;   ///< [m] keyframes of the drive, one at least
  std::vector<Eigen::Vector3d> in_group;  ///< [m] the same keyframes, as the group has them
};

/// Places a group by the GNSS of its drives: the yaw and translation that agree best with all their
/// alignments, each by its whole covariance, since receivers err independently on different days.
/// Nothing without any drive. Gauss-Newton over [yaw, x, y, z].
std::optional<Rigid3> PlaceByGnss(std::span<const GnssDrive> drives);

}  // namespace parkade
