#pragma once

#include "slam/refinement/covariance_modes.h"
#include "slam/sessions/drive_to_join.h"

namespace parkade {

/// Makes covariance modes for a drive whose refinement gives none: those of the random walk that
/// AddKeyframes gives its keyframes, held together by its own loops. Position and yaw of the first
/// keyframe are certain.
CovarianceModes RandomWalkModes(const DriveToJoin& drive, const LoopOptions& options);

}  // namespace parkade
