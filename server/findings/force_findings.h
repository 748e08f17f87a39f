#pragma once

#include <optional>

#include "core/rig.h"
#include "server/ingest/checks/finding.h"
#include "slam/odometry/odometry_result.h"

namespace parkade {

/// An accelerometer that is so far off that without wheels nobody can tell whether it is by its
/// zero, which is used, or by its scale, which then is also that of the path.
std::optional<Finding> WrongForces(const OdometryReport& odometry);

/// An accelerometer that reads gravity too large by about the share by which wheels say that the
/// path is too long: a zero that is off would leave the path as it is, wheels of another size would
/// leave gravity.
std::optional<Finding> WrongForceScale(const OdometryReport& odometry, const Rig& rig);

}  // namespace parkade
