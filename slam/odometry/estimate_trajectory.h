#pragma once

#include <functional>

#include "core/drive_log.h"
#include "slam/odometry/odometry_options.h"
#include "slam/odometry/odometry_result.h"

namespace parkade {

/// Called now and then with how far the pass over the log has come, in [0, 1].
using ProgressCallback = std::function<void(double fraction)>;

/// Estimates the way of the car from one pass over a drive: features tracked
/// per camera (in parallel, and beside the estimator), IMU, wheels where there
/// are any, one fixed-lag smoother. No loop closure.
///
/// Wheels that contradict the rest (CompareWheels) are left out, as the report says.
///
/// The trajectory covers the span of the IMU data. Survives lost cameras,
/// darkness, gaps and bad records, and reports them. Throws Error{kInvalidInput}
/// with one sentence when the log cannot be mapped: no IMU, no camera and no wheels, too
/// short, or no start found; Error{kUsage} for bad options. The same log gives
/// the same bytes. Memory does not grow with the images of the drive.
OdometryResult EstimateTrajectory(const DriveLog& log, const OdometryOptions& options = {},
                                  const ProgressCallback& progress = {});

}  // namespace parkade
