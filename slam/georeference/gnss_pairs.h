#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/drive_log.h"
#include "core/geo.h"
#include "core/trajectory.h"

namespace parkade {

/// Fixes beside the antenna positions that odometry gives for their times.
struct GnssPairs {
  Eigen::Matrix3Xd antenna_in_odom;
  Eigen::Matrix3Xd antenna_in_site;
  Eigen::Matrix3Xd sigma;  ///< [m] east, north, up; odometry drift included
  Eigen::VectorXd times;   ///< [s] since the first
  Eigen::VectorXd arms;    ///< [m] of way from the middle of the drive

  Eigen::Index size() const { return sigma.cols(); }
};

/// The position of the first fix. A receiver that starts up may report (0, 0) or its last parking
/// place: that fix is the datum only if most others are near. `fixes` are not empty.
SiteDatum ChooseDatum(const std::vector<GnssFix>& fixes);

/// \param fixes  in order of time, within the trajectory's span
/// \param drift  [m/m] how far odometry may bend
GnssPairs MakeGnssPairs(const Trajectory& trajectory, const std::vector<GnssFix>& fixes,
                        const Eigen::Vector3d& antenna_in_body, const SiteDatum& datum,
                        double drift);

/// Where the fixes lie beside the antenna, one column each [m].
Eigen::Matrix3Xd Residuals(const GnssPairs& pairs, const Rigid3& site_from_odom);

/// Squared residuals in units of their variances, summed over the axes.
Eigen::VectorXd SquaredErrors(const GnssPairs& pairs, const Rigid3& site_from_odom);

}  // namespace parkade
