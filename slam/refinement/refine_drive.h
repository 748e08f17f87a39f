#pragma once

#include "core/drive_log.h"
#include "slam/loops/loop_closure.h"
#include "slam/odometry/odometry_result.h"
#include "slam/refinement/drive_refinement.h"
#include "slam/refinement/refinement_options.h"

namespace parkade {

/// Reads them from the log; the antenna is where the rig has it.
GnssPositions ReadGnss(const DriveLog& log, const GnssAlignOptions& options);

/// Batch adjustment of a drive (IMU, wheels, bearings, calibration, accepted loops, GNSS),
/// warm-started from the pose graph. A share of the tracks, and of the loops where there are
/// enough, is held out at first; only where the tracks fit the poses better than before, the loops'
/// error stays within what they claim or does not grow, and the IMU still agrees is the result
/// taken, and they join in a last solve. `rig` is what the log says. Nothing is done, with a
/// reason, where a mount turned during the drive.
DriveRefinement RefineDrive(const OdometryResult& odometry, const Rig& rig,
                            const LoopClosure& closure, const RefinementOptions& options,
                            const GnssPositions& gnss = {});

}  // namespace parkade
