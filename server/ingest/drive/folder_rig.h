#pragma once

#include "core/rig.h"
#include "server/ingest/files/drive_folder.h"

namespace parkade {

/// The rig that a drive's folder brings: EuRoC's sensor.yaml, KITTI's calib_*.txt. Throws
/// Error{kInvalidInput} saying what is missing or wrong.
Rig ReadFolderRig(const DriveFolder& folder);

}  // namespace parkade
