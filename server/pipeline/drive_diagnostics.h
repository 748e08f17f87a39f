#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/site_map.h"
#include "slam/odometry/odometry_result.h"
#include "slam/refinement/drive_residuals.h"
#include "slam/refinement/refine_drive.h"

namespace parkade {

/// What there is to plot of a drive over time, beside its trajectory.
struct DriveDiagnostics {
  std::vector<OdometryKeyframe> keyframes;
  DriveResiduals residuals;
  GnssPositions gnss;
};

/// What the odometry measured, held against the refined trajectory. Nothing without measurements.
DriveResiduals MeasureResiduals(const OdometryResult& odometry, const Rig& log_rig,
                                const DriveRefinement& refinement,
                                const RefinementOptions& options);

/// diagnostics.json of a drive: series over time with their units, and the stretches that were less
/// sure than the rest. Times are seconds since `start`. A series that the drive has nothing for is
/// left out. `datum`: of the site; without one, GNSS cannot be held against the trajectory.
std::string EncodeDiagnostics(const SiteDrive& drive, const DriveDiagnostics& diagnostics,
                              const OdometryReport& report, const std::optional<SiteDatum>& datum);

/// keyframes.json of a drive: the cameras where they are mounted, and the images that odometry
/// found worth keeping, with the car's pose in the site.
std::string EncodeKeyframes(const SiteDrive& drive, const std::vector<OdometryKeyframe>& keyframes);

}  // namespace parkade
