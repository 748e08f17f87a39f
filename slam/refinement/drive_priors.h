#pragma once

#include "core/rig.h"
#include "slam/refinement/adjusted_drive.h"

namespace parkade {

/// Adds what is known of a drive beside its measurements: where it begins, how its sensors are
/// about, and how its log's `rig` has the cameras. Cameras of a stereo head are held.
void AddDrivePriors(const Rig& rig, AdjustedDrive& drive);

}  // namespace parkade
