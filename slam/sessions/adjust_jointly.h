#pragma once

#include <vector>

#include "core/rigid3.h"
#include "slam/sessions/drive_to_join.h"
#include "slam/sessions/settled_drives.h"

namespace parkade {

/// What AdjustJointly did.
struct JointAdjustment {
  int num_links = 0;
  double before = 0, after = 0;   ///< median squared error of the links that count [sigma^2]
  double largest_correction = 0;  ///< [m] of a keyframe
  double seconds = 0;             ///< of computing
};

/// Drives that hang together, adjusted at once: the unknowns of each are its frame (yaw,
/// translation), the amounts of its covariance modes and the errors of its cameras' mounts (see
/// RelativePoseOptions); the measurements are the links between drives. Modes are principal
/// components of what a drive's own refinement left open (CovarianceModes), so that this is the
/// bundle adjustment of all drives together, linear around the solution of each, with some dozens
/// of unknowns per drive; images are not looked at again. Of settled
/// drives the mounts alone are unknown; without them the frame of the first drive stays.
///
/// Links are weighed with a Cauchy loss and share what they know (SharesOf). Mounts that are off
/// move all links of a drive alike, one way where two cars head the same way, the other way where
/// they do not: were they not estimated, they would bend the drive.
///
/// \param loops  where drives without modes get theirs from (RandomWalkModes)
/// \param pairs  of the group; links of weight 0 pull nothing. Their chi_squared becomes that of
/// the solution \param group_from_keyframe  per drive of `drives`: its keyframes where the joint
/// graph has them; moved. Empty where the
///     drive is not of the group
JointAdjustment AdjustJointly(const std::vector<DriveToJoin>& drives, const LoopOptions& loops,
                              const SettledDrives& settled, const std::vector<DrivePair*>& pairs,
                              std::vector<std::vector<Rigid3>>& group_from_keyframe);

}  // namespace parkade
