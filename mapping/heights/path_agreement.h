#pragma once

#include <span>
#include <vector>

#include "core/trajectory.h"

namespace parkade {

/// Poses of a path by which HoldAlong tells later whether it moved: one every two meters or 0.3
/// rad, and the last.
std::vector<TimedPose> SparsePoses(const Trajectory& site_from_body);

/// Whether heights that were measured along `before` hold along the path of today: poses near
/// enough for their views to have measured a height together (32 m) lie to each other as they did,
/// to 0.2 mrad and 3 mm, and 0.2 mm more per meter beyond 12 m. Where the path as a whole has moved
/// or is bent slowly they do, and heights go with the poses that they are tied to (DriveHeight).
bool HoldAlong(std::span<const TimedPose> before, const Trajectory& now);

}  // namespace parkade
