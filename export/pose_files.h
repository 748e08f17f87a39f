#pragma once

#include <span>
#include <string>

#include "core/trajectory.h"

namespace parkade {

/// KITTI odometry's poses: per line the upper three rows of the 4 x 4 matrix of world_from_frame,
/// row by row. The format has no times.
std::string EncodeKittiPoses(std::span<const TimedPose> poses);

/// ASL's state_groundtruth_estimate0: `#timestamp [ns], p_x [m], p_y, p_z, q_w, q_x, q_y, q_z`.
std::string EncodeEurocPoses(std::span<const TimedPose> poses);

}  // namespace parkade
