#pragma once

#include <optional>
#include <string>

#include "core/site_map.h"

namespace parkade {

/// How sure a drive's final poses are, as CSV with one header line that names columns and units. A
/// row per 0.1 s at the times of odometry's states, which trajectory.tum has too:
///
///   t                           [s] as in trajectory.tum
///   21 numbers                  upper triangle, row by row, of the 6 x 6 covariance of [rx ry rz |
///   x y z]: a small turn
///                               of the IMU in its own axes, R exp(r) [rad], and its position along
///                               the site's axes [m]
/// site x, y, z [m], yaw [rad] sigmas of where the site itself puts this position on Earth; nan
/// where no datum is known
///
/// The 21 numbers are of errors since the drive's first state, whose position and yaw count as
/// exact: the refinement gives them, or the odometry where that was not accepted. Other drives of
/// the site make poses better than that. The error of where the site lies comes on top; the two are
/// independent.
std::string EncodeCovarianceCsv(const SiteDrive& drive,
                                const std::optional<SitePlacement>& placement);

}  // namespace parkade
