#pragma once

#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"
#include "slam/places/keyframe_options.h"
#include "slam/places/triangulation_queue.h"

namespace parkade {

/// Raised when the same images give other keyframes, or keyframes of drives other links.
constexpr int kKeyframesVersion = 2;

/// Places keyframes along the drive, without features.
std::vector<RigKeyframe> ChooseKeyframes(const Trajectory& odom_from_body,
                                         const KeyframeOptions& options);

/// Looks again at images of the keyframes that are wanted (one flag each), one per camera and
/// keyframe: corners with ORB descriptors on upright views (CylinderView), at all sizes down to one
/// that cameras of any resolution have, and where neighboring keyframes see a corner too, its point
/// by the odometry's motion. One pass over the log; images are worked on in parallel batches.
/// `sink` gets all keyframes in their order as they are done: only some dozens are in memory with
/// their features.
void DescribeKeyframes(const DriveLog& log, const Trajectory& odom_from_body,
                       const KeyframeOptions& options, const std::vector<bool>& is_wanted,
                       std::vector<RigKeyframe> keyframes, const KeyframeSink& sink);

}  // namespace parkade
