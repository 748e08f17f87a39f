#pragma once

#include <filesystem>

#include "core/rig.h"

namespace parkade {

/// The rig of a KITTI raw drive, whose images are rectified: lenses and mounts by
/// calib_cam_to_cam.txt, calib_velo_to_cam.txt and calib_imu_to_velo.txt in `folder` or above it,
/// the rear axle by the drawing of KITTI's car (Geiger et al., "Vision meets robotics: the KITTI
/// dataset", IJRR 2013, fig. 3). Throws Error{kInvalidInput} naming the file and the key that is
/// missing or wrong.
Rig ReadKittiRig(const std::filesystem::path& folder);

}  // namespace parkade
