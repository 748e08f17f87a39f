#include "slam/align_to_gnss.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "slam/align_points.h"

namespace parkade {
namespace {

constexpr int kMinInliers = 5;
constexpr double kOutlierSquaredError = 11.34;  ///< chi-square, 3 degrees of freedom, 99 %
constexpr double kMinSigma = 0.01;              ///< [m] receivers that claim less are not believed
constexpr double kMaxSiteRadius = 10e3;         ///< [m]

/// Fixes beside the antenna positions that odometry gives for their times.
struct Pairs {
  Eigen::Matrix3Xd antenna_in_odom;
  Eigen::Matrix3Xd antenna_in_site;
  Eigen::Matrix3Xd sigma;    ///< [m] east, north, up; odometry drift included
  double mean_interval = 0;  ///< [s]

  Eigen::Index size() const { return sigma.cols(); }
};

Eigen::Vector3d InEarth(const GnssFix& fix) {
  return EarthFromSite({fix.latitude_deg, fix.longitude_deg, fix.altitude}).translation;
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A receiver that starts up may report (0, 0) or its last parking place: the
/// first fix is the datum only if most others are near.
SiteDatum ChooseDatum(const std::vector<GnssFix>& fixes) {
  std::vector<double> axes[3];
  for (const GnssFix& fix : fixes) {
    const Eigen::Vector3d in_earth = InEarth(fix);
    for (int axis = 0; axis < 3; ++axis) axes[axis].push_back(in_earth[axis]);
  }
  const Eigen::Vector3d centre(Median(axes[0]), Median(axes[1]), Median(axes[2]));
  const auto first = std::find_if(fixes.begin(), fixes.end(),
                                  [&](const GnssFix& fix) { return (InEarth(fix) - centre).norm() < kMaxSiteRadius; });
  const GnssFix& fix = first == fixes.end() ? fixes.front() : *first;
  return {fix.latitude_deg, fix.longitude_deg, fix.altitude};
}

Pairs MakePairs(const Trajectory& trajectory, const std::vector<GnssFix>& fixes, const Eigen::Vector3d& antenna_in_body,
                const SiteDatum& datum, double drift) {
  Pairs pairs;
  const auto count = static_cast<Eigen::Index>(fixes.size());
  for (Eigen::Matrix3Xd* points : {&pairs.antenna_in_odom, &pairs.antenna_in_site, &pairs.sigma})
    points->resize(3, count);
  std::vector<double> travelled(fixes.size(), 0.0);
  for (Eigen::Index i = 0; i < count; ++i) {
    const GnssFix& fix = fixes[static_cast<size_t>(i)];
    pairs.antenna_in_odom.col(i) = trajectory.At(fix.time).value() * antenna_in_body;
    pairs.antenna_in_site.col(i) = SiteFromGeodetic(datum, fix.latitude_deg, fix.longitude_deg, fix.altitude);
    if (i > 0)
      travelled[static_cast<size_t>(i)] = travelled[static_cast<size_t>(i - 1)] +
                                          (pairs.antenna_in_odom.col(i) - pairs.antenna_in_odom.col(i - 1)).norm();
  }
  // Drift grows away from the middle of the drive, where the alignment is best.
  for (Eigen::Index i = 0; i < count; ++i) {
    const double bend = drift * (travelled[static_cast<size_t>(i)] - 0.5 * travelled.back());
    const Eigen::Vector3d sigma = fixes[static_cast<size_t>(i)].sigma_enu.cwiseMax(kMinSigma);
    pairs.sigma.col(i) = (sigma.array().square() + bend * bend).sqrt();
  }
  if (count > 1) pairs.mean_interval = (fixes.back().time - fixes.front().time) / static_cast<double>(count - 1);
  return pairs;
}

Eigen::Matrix3Xd Residuals(const Pairs& pairs, const Rigid3& site_from_odom) {
  Eigen::Matrix3Xd residuals = pairs.antenna_in_site;
  for (Eigen::Index i = 0; i < pairs.size(); ++i)
    residuals.col(i) -= site_from_odom * Eigen::Vector3d(pairs.antenna_in_odom.col(i));
  return residuals;
}

Eigen::VectorXd SquaredErrors(const Pairs& pairs, const Rigid3& site_from_odom) {
  return (Residuals(pairs, site_from_odom).array() / pairs.sigma.array()).square().colwise().sum().transpose();
}

Rigid3 Fit(const Pairs& pairs, const Eigen::VectorXd& weights) {
  const Eigen::ArrayXd horizontal_variance = 0.5 * pairs.sigma.topRows<2>().colwise().squaredNorm().transpose();
  const Eigen::ArrayXd vertical_variance = pairs.sigma.row(2).array().square().transpose();
  return AlignYawAndTranslation(pairs.antenna_in_odom, pairs.antenna_in_site, weights.array() / horizontal_variance,
                                weights.array() / vertical_variance);
}

struct RobustFit {
  Rigid3 site_from_odom;
  Eigen::VectorXd weights;  ///< in (0, 1]: how far each fix is believed
};

RobustFit FitRobustly(const Pairs& pairs) {
  RobustFit fit;
  fit.weights = Eigen::VectorXd::Ones(pairs.size());
  fit.site_from_odom = Fit(pairs, fit.weights);
  double control = std::max(1.0, 2 * SquaredErrors(pairs, fit.site_from_odom).maxCoeff() / kOutlierSquaredError);
  for (bool is_last = false; !is_last; control = std::max(1.0, control / 1.4)) {
    is_last = control == 1.0;
    const double scale = control * kOutlierSquaredError;
    // A few steps per level: the closed form converges at once for given weights.
    for (int step = 0; step < 3; ++step) {
      const Eigen::ArrayXd squared = SquaredErrors(pairs, fit.site_from_odom).array();
      fit.weights = (scale / (squared + scale)).square();
      fit.site_from_odom = Fit(pairs, fit.weights);
    }
  }
  return fit;
}

/// Of [yaw, x, y, z] at `centre`, for independent errors of the given sigmas.
Eigen::Matrix4d Information(const Pairs& pairs, const RobustFit& fit, const Eigen::Vector3d& centre_in_odom) {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  for (Eigen::Index i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d arm = fit.site_from_odom.rotation * (pairs.antenna_in_odom.col(i) - centre_in_odom);
    Eigen::Matrix<double, 3, 4> jacobian;
    jacobian << Eigen::Vector3d(-arm.y(), arm.x(), 0), Eigen::Matrix3d::Identity();
    const Eigen::Vector3d precision = pairs.sigma.col(i).array().square().inverse();
    information += fit.weights[i] * jacobian.transpose() * precision.asDiagonal() * jacobian;
  }
  return information;
}

double Quantile(std::vector<double> sorted_values, double share) {
  std::sort(sorted_values.begin(), sorted_values.end());
  const double position = share * static_cast<double>(sorted_values.size() - 1);
  return sorted_values[static_cast<size_t>(std::ceil(position))];
}

/// Everything but the datum.
GnssAlignment Describe(const Pairs& pairs, const RobustFit& fit, double correlation_time) {
  GnssAlignment alignment;
  alignment.site_from_odom = fit.site_from_odom;
  const Eigen::Matrix3Xd residuals = Residuals(pairs, fit.site_from_odom);
  const Eigen::VectorXd squared = SquaredErrors(pairs, fit.site_from_odom);
  const Eigen::Vector3d centre_in_odom = pairs.antenna_in_odom * fit.weights / fit.weights.sum();
  alignment.num_fixes = static_cast<int>(pairs.size());
  double horizontal = 0, vertical = 0, squared_sum = 0;
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < pairs.size(); ++i) {
    distances.push_back(residuals.col(i).head<2>().norm());
    if (squared[i] > kOutlierSquaredError) continue;
    ++alignment.num_inliers;
    horizontal += residuals.col(i).head<2>().squaredNorm();
    vertical += residuals(2, i) * residuals(2, i);
    squared_sum += squared[i];
    alignment.extent = std::max(alignment.extent, (pairs.antenna_in_odom.col(i) - centre_in_odom).head<2>().norm());
  }
  const double count = std::max(1, alignment.num_inliers);
  alignment.horizontal_rmse = std::sqrt(horizontal / count);
  alignment.vertical_rmse = std::sqrt(vertical / count);
  alignment.cep50 = Quantile(distances, 0.50);
  alignment.cep95 = Quantile(distances, 0.95);

  // Fixes in quick succession share their errors; and residuals larger than
  // claimed say that the claims were too small.
  const double shared = std::max(1.0, correlation_time / std::max(pairs.mean_interval, 1e-3));
  const double repeats = std::min(shared, count);
  const double excess = std::max(1.0, squared_sum / (3 * count));
  const Eigen::Matrix4d information = Information(pairs, fit, centre_in_odom);
  // The floor keeps the heading of a car that stands still finite (and useless).
  alignment.covariance =
      repeats * excess * (information + 1e-6 * Eigen::Matrix4d::Identity()).ldlt().solve(Eigen::Matrix4d::Identity());
  return alignment;
}

}  // namespace

void GnssAlignOptions::Validate() const {
  Require(max_fix_sigma > 0, ErrorCode::kUsage, "max_fix_sigma must be > 0 m");
  Require(max_yaw_sigma > 0, ErrorCode::kUsage, "max_yaw_sigma must be > 0 rad");
  Require(odometry_drift >= 0, ErrorCode::kUsage, "odometry_drift must be >= 0");
  Require(correlation_time >= 0, ErrorCode::kUsage, "correlation_time must be >= 0 s");
}

bool IsUsable(const GnssFix& fix, const Trajectory& odom_from_body, double max_sigma) {
  const bool is_finite = std::isfinite(fix.latitude_deg) && std::isfinite(fix.longitude_deg) &&
                         std::isfinite(fix.altitude) && fix.sigma_enu.allFinite();
  return is_finite && std::abs(fix.latitude_deg) <= 90 && fix.sigma_enu.minCoeff() >= 0 &&
         fix.sigma_enu.head<2>().maxCoeff() <= max_sigma && odom_from_body.span().Contains(fix.time);
}

double GnssAlignment::YawSigma() const { return std::sqrt(covariance(0, 0)); }

std::optional<GnssAlignment> AlignToGnss(const Trajectory& odom_from_body, const std::vector<GnssFix>& fixes,
                                         const Eigen::Vector3d& antenna_in_body, const GnssAlignOptions& options,
                                         const std::optional<SiteDatum>& datum) {
  options.Validate();
  std::vector<GnssFix> usable;
  std::copy_if(fixes.begin(), fixes.end(), std::back_inserter(usable),
               [&](const GnssFix& fix) { return IsUsable(fix, odom_from_body, options.max_fix_sigma); });
  if (usable.size() < static_cast<size_t>(kMinInliers)) return std::nullopt;

  const SiteDatum site_datum = datum ? *datum : ChooseDatum(usable);
  const Pairs pairs = MakePairs(odom_from_body, usable, antenna_in_body, site_datum, options.odometry_drift);
  GnssAlignment alignment = Describe(pairs, FitRobustly(pairs), options.correlation_time);
  alignment.datum = site_datum;
  const bool most_agree = alignment.num_inliers >= kMinInliers && 2 * alignment.num_inliers >= alignment.num_fixes;
  if (!most_agree || alignment.YawSigma() > options.max_yaw_sigma) return std::nullopt;
  return alignment;
}

}  // namespace parkade
