#include "slam/georeference/gnss_pairs.h"

#include <algorithm>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kMinSigma = 0.01;       ///< [m] receivers that claim less are not believed
constexpr double kMaxSiteRadius = 10e3;  ///< [m]

Eigen::Vector3d InEarth(const GnssFix& fix) {
  return EarthFromSite({fix.latitude_deg, fix.longitude_deg, fix.altitude}).translation;
}

}  // namespace

SiteDatum ChooseDatum(const std::vector<GnssFix>& fixes) {
  std::vector<double> axes[3];
  for (const GnssFix& fix : fixes) {
    const Eigen::Vector3d in_earth = InEarth(fix);
    for (int axis = 0; axis < 3; ++axis) axes[axis].push_back(in_earth[axis]);
  }
  const Eigen::Vector3d center(Median(axes[0]), Median(axes[1]), Median(axes[2]));
  const auto first = std::find_if(fixes.begin(), fixes.end(), [&](const GnssFix& fix) {
    return (InEarth(fix) - center).norm() < kMaxSiteRadius;
  });
  const GnssFix& fix = first == fixes.end() ? fixes.front() : *first;
  const auto known = std::find_if(fixes.begin(), fixes.end(),
                                  [](const GnssFix& other) { return other.HasAltitude(); });
  const bool is_altitude_known = known != fixes.end();
  const double altitude = fix.HasAltitude()   ? fix.altitude
                          : is_altitude_known ? known->altitude
                                              : 0;
  return {fix.latitude_deg, fix.longitude_deg, altitude, is_altitude_known};
}

GnssPairs MakeGnssPairs(const Trajectory& trajectory, const std::vector<GnssFix>& fixes,
                        const Eigen::Vector3d& antenna_in_body, const SiteDatum& datum,
                        double drift) {
  GnssPairs pairs;
  const auto count = static_cast<Eigen::Index>(fixes.size());
  for (Eigen::Matrix3Xd* points : {&pairs.antenna_in_odom, &pairs.antenna_in_site, &pairs.sigma})
    points->resize(3, count);
  pairs.times.resize(count);
  pairs.arms.resize(count);
  std::vector<double> traveled(fixes.size(), 0.0);
  for (Eigen::Index i = 0; i < count; ++i) {
    const GnssFix& fix = fixes[static_cast<size_t>(i)];
    pairs.times[i] = fix.time - fixes.front().time;
    pairs.antenna_in_odom.col(i) = trajectory.At(fix.time).value() * antenna_in_body;
    pairs.antenna_in_site.col(i) =
        SiteFromGeodetic(datum, fix.latitude_deg, fix.longitude_deg, fix.altitude);
    if (i > 0)
      traveled[static_cast<size_t>(i)] =
          traveled[static_cast<size_t>(i - 1)] +
          (pairs.antenna_in_odom.col(i) - pairs.antenna_in_odom.col(i - 1)).norm();
  }
  // Drift grows away from the middle of the drive, where the alignment is best.
  for (Eigen::Index i = 0; i < count; ++i) {
    pairs.arms[i] = traveled[static_cast<size_t>(i)] - 0.5 * traveled.back();
    const double bend = drift * pairs.arms[i];
    const Eigen::Vector3d sigma = fixes[static_cast<size_t>(i)].sigma_enu.cwiseMax(kMinSigma);
    pairs.sigma.col(i) = (sigma.array().square() + bend * bend).sqrt();
  }
  return pairs;
}

Eigen::Matrix3Xd Residuals(const GnssPairs& pairs, const Rigid3& site_from_odom) {
  Eigen::Matrix3Xd residuals = pairs.antenna_in_site;
  for (Eigen::Index i = 0; i < pairs.size(); ++i)
    residuals.col(i) -= site_from_odom * Eigen::Vector3d(pairs.antenna_in_odom.col(i));
  return residuals;
}

Eigen::VectorXd SquaredErrors(const GnssPairs& pairs, const Rigid3& site_from_odom) {
  return (Residuals(pairs, site_from_odom).array() / pairs.sigma.array())
      .square()
      .colwise()
      .sum()
      .transpose();
}

}  // namespace parkade
