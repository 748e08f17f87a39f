#pragma once

#include <optional>
#include <vector>

#include "core/trajectory.h"

namespace parkade {

/// How large errors are in units of what the estimate believes: normalized
/// estimation error squared (NEES), per degree of freedom. 1 is honest, more is
/// overconfident. Y. Bar-Shalom et al., "Estimation with Applications to Tracking
/// and Navigation", 2001, section 5.4.
struct PoseConsistency {
  double time = 0;            ///< [s] after the start
  double pose = 0;            ///< of all six: [rotation, position]
  double rotation = 0;        ///< of rotation alone
  double position = 0;        ///< of position alone
  double rotation_error = 0;  ///< [rad]
  double position_error = 0;  ///< [m]
};

/// NEES at `shares` (0..1) of the time from the start of the estimate to its end.
///
/// The odom frame is the estimate's choice of yaw and position at its first node,
/// where they are exact by definition: the truth is turned and moved (yaw and
/// position only) to meet the estimate there, at the IMU. The start is the state
/// of least position variance; states before it have no covariance of this kind.
///
/// \param truth  `world_from_body`, in order of time, dense
/// \return nothing where the estimate has no covariance or the truth no such times
std::vector<PoseConsistency> MeasureConsistency(const Trajectory& odom_from_body,
                                                const std::vector<TimedPose>& truth,
                                                const Rigid3& body_from_imu,
                                                const std::vector<double>& shares);

/// 2.5 % and 97.5 % of the mean of `num_runs` NEES per degree of freedom of an
/// honest estimator, each of `freedom` degrees (E. Wilson, M. Hilferty, "The
/// distribution of chi-square", PNAS 1931).
struct ConfidenceBounds {
  double low = 0, high = 0;
};
ConfidenceBounds BoundsOfMean(int num_runs, int freedom);

}  // namespace parkade
