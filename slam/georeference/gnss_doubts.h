#pragma once

#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"

namespace parkade {

/// What speaks against the fixes of a drive: they stay at one spot while the car moves, or their
/// track is none that the car drove, as with latitude and longitude in each other's place or in
/// radians. "contradict the trajectory: ..."; empty where they may be believed, or the drive is too
/// short to tell. Single wild fixes are no doubt: most have to be wrong.
///
/// \param max_sigma  [m] fixes that claim less accuracy are not looked at
std::string DoubtOfFixes(const Trajectory& odom_from_body, const std::vector<GnssFix>& fixes,
                         double max_sigma);

}  // namespace parkade
