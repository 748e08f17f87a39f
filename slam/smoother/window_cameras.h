#pragma once

#include "core/rig.h"
#include "slam/smoother/smoother_options.h"
#include "slam/smoother/smoother_window.h"

namespace parkade {

/// The rig's cameras, with what is to be estimated of their calibration.
void AddCameras(const Rig& rig, const CalibrationOptions& options, SmootherWindow& window);

/// Appends the cameras to the window's prior: the rig may be off by the settings' sigmas, and
/// within a stereo head by much less.
void AddPriorOfCameras(SmootherWindow& window);

/// Moves each camera's noise scale towards what the bearings of the last solve show.
void UpdateCameraNoise(SmootherWindow& window);

}  // namespace parkade
