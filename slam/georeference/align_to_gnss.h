#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/drive_log.h"
#include "core/geo.h"
#include "core/option_about.h"
#include "core/rigid3.h"
#include "core/trajectory.h"

namespace parkade {

struct GnssAlignOptions {
  double max_fix_sigma = 10;      ///< [m] horizontal; fixes that claim less accuracy are left out
  double max_yaw_sigma = 0.1;     ///< [rad] heading less sure than this: no alignment
  double odometry_drift = 0.003;  ///< [m/m] how far odometry may bend away from GNSS
  double correlation_time = 60;   ///< [s] of the slow part of the fixes' errors; 0: there is none

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("max_fix_sigma", max_fix_sigma,
          OptionAbout{"Fixes that declare a larger sigma are left out.", "m", 0.01, 1000});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Where a drive lies on Earth.
struct GnssAlignment {
  SiteDatum datum;        ///< origin of `site`
  Rigid3 site_from_odom;  ///< yaw and translation; both worlds have z up
  Eigen::Matrix4d covariance =
      Eigen::Matrix4d::Zero();  ///< of [yaw (rad), x, y, z (m) of the fixes' center]
  Eigen::Vector3d center_in_odom = Eigen::Vector3d::Zero();  ///< [m] of the fixes
  double extent = 0;    ///< [m] largest horizontal distance of a used fix from their center
  int num_fixes = 0;    ///< with a pose at their time and of acceptable sigma
  int num_inliers = 0;  ///< of these, not rejected by the robust fit
  std::vector<Timestamp> outliers = {};           ///< times of those that it rejected
  double horizontal_rmse = 0, vertical_rmse = 0;  ///< [m] of the inliers
  double cep50 = 0,
         cep95 = 0;  ///< [m] horizontal error that 50 % and 95 % of all num_fixes stay under

  double YawSigma() const;  ///< [rad]
};

/// How well the place on Earth of a site is known that these drives' GNSS gave it, all in one
/// datum. The drives err independently.
SitePlacement PlacementBy(const std::vector<GnssAlignment>& drives);

/// Whether a fix is whole, within the trajectory's span, and claims at most `max_sigma` [m]
/// horizontally.
bool IsUsable(const GnssFix& fix, const Trajectory& odom_from_body, double max_sigma);

/// Finds the site frame for one drive: rotation about z and translation such that
/// the antenna of the trajectory lies on the fixes. Robust by graduated
/// non-convexity with the Geman-McClure loss: H. Yang et al., "Graduated
/// non-convexity for robust spatial perception", RA-L 2020, eq. 9-12. Then least squares in which
/// the errors of successive fixes are correlated as their differences show (WhitenRows): that gives
/// the ends of the drive, where heading comes from, their right weight, and a covariance that does
/// not take a thousand fixes for a thousand answers.
///
/// \param odom_from_body    gravity-aligned; fixes outside its span are left out
/// \param antenna_in_body   [m] lever arm
/// \param datum             a site that exists already; otherwise the first fix
///                          that agrees with the others to 10 km
/// \return nothing when heading is not observable (too short a path for the
///         fixes' accuracy, too few fixes) or less than half of the fixes agree
std::optional<GnssAlignment> AlignToGnss(const Trajectory& odom_from_body,
                                         const std::vector<GnssFix>& fixes,
                                         const Eigen::Vector3d& antenna_in_body,
                                         const GnssAlignOptions& options = {},
                                         const std::optional<SiteDatum>& datum = std::nullopt);

}  // namespace parkade
