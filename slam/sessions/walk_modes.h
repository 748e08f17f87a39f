#pragma once

#include "slam/refinement/bending_modes.h"
#include "slam/sessions/drive_to_join.h"

namespace parkade {

/// Of a drive whose refinement tells none: those of the random walk that AddPlaces gives its places, held together by
/// its own loops. Position and yaw of the first place are certain.
BendingModes WalkModes(const DriveToJoin& drive, const LoopOptions& options);

}  // namespace parkade
