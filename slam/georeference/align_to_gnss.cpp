#include "slam/georeference/align_to_gnss.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/math/statistics.h"
#include "slam/georeference/align_points.h"
#include "slam/georeference/correlated_errors.h"
#include "slam/georeference/gnss_pairs.h"

namespace parkade {
namespace {

constexpr int kMinInliers = 5;
constexpr double kOutlierSquaredError = 11.34;  ///< chi-square, 3 degrees of freedom, 99 %
constexpr double kLongArm = 20;                 ///< [m] from which on residuals tell of bends
constexpr double kLeastBend = 1e-4;             ///< [m/m]
constexpr double kBendsPerMedian = 1.5;
constexpr double kSigmasOfExtent = 2;  ///< a drive must extend this far for a heading
constexpr double kMostWhiteVariance =
    0.7;  ///< a drive may be too short to show that a receiver errs slowly
constexpr int kCorrelatedRounds = 3;  ///< after the robust fit, which is near

Rigid3 Fit(const GnssPairs& pairs, const Eigen::VectorXd& weights) {
  const Eigen::ArrayXd horizontal_variance =
      0.5 * pairs.sigma.topRows<2>().colwise().squaredNorm().transpose();
  const Eigen::ArrayXd vertical_variance = pairs.sigma.row(2).array().square().transpose();
  return AlignYawAndTranslation(pairs.antenna_in_odom, pairs.antenna_in_site,
                                weights.array() / horizontal_variance,
                                weights.array() / vertical_variance);
}

struct RobustFit {
  Rigid3 site_from_odom;
  Eigen::VectorXd weights;  ///< in (0, 1]: how far each fix is believed
};

RobustFit FitRobustly(const GnssPairs& pairs) {
  RobustFit fit;
  fit.weights = Eigen::VectorXd::Ones(pairs.size());
  fit.site_from_odom = Fit(pairs, fit.weights);
  double control =
      std::max(1.0, 2 * SquaredErrors(pairs, fit.site_from_odom).maxCoeff() / kOutlierSquaredError);
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

/// How far odometry bends at most, by what the fit leaves: much less than it may where fixes are
/// exact and agree.
double BendOf(const GnssPairs& pairs, const RobustFit& fit, double drift) {
  const Eigen::Matrix3Xd residuals = Residuals(pairs, fit.site_from_odom);
  std::vector<double> bends;
  for (Eigen::Index i = 0; i < pairs.size(); ++i)
    if (std::abs(pairs.arms[i]) > kLongArm)
      bends.push_back(residuals.col(i).head<2>().norm() / std::abs(pairs.arms[i]));
  if (bends.empty()) return drift;
  return std::min(drift, std::max(kLeastBend, kBendsPerMedian * Median(bends)));
}

/// How the fit changes with [yaw, x, y, z] at a center, and how sure that is.
struct LinearFit {
  Eigen::Vector4d step;
  Eigen::Matrix4d covariance;
};

/// Least squares that knows that errors of fixes in quick succession are nearly the same.
LinearFit FitCorrelated(const GnssPairs& pairs, const RobustFit& fit,
                        const Eigen::Vector3d& center_in_odom, double correlation_time) {
  const Eigen::Matrix3Xd residuals = Residuals(pairs, fit.site_from_odom);
  Eigen::Matrix4d information =
      1e-6 * Eigen::Matrix4d::Identity();  // a car that stands still has no heading
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  double squared_sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(pairs.size(), 5);  // [Jacobian | residual]
    for (Eigen::Index i = 0; i < pairs.size(); ++i) {
      const Eigen::Vector3d arm =
          fit.site_from_odom.rotation * (pairs.antenna_in_odom.col(i) - center_in_odom);
      rows(i, 0) = axis == 0 ? -arm.y() : axis == 1 ? arm.x() : 0;
      rows(i, 1 + axis) = 1;
      rows(i, 4) = residuals(axis, i);
      rows.row(i) /= pairs.sigma(axis, i);
    }
    const double white = EstimateWhiteVariance(rows.col(4), pairs.times, correlation_time);
    const ErrorModel model{correlation_time, std::min(white, kMostWhiteVariance)};
    const Eigen::MatrixXd whitened = WhitenRows(rows, pairs.times, fit.weights, model);
    information += whitened.leftCols<4>().transpose() * whitened.leftCols<4>();
    gradient += whitened.leftCols<4>().transpose() * whitened.col(4);
    squared_sum += whitened.col(4).squaredNorm();
  }
  // Residuals larger than claimed say that the claims were too small.
  const double excess = std::max(1.0, squared_sum / (3 * static_cast<double>(pairs.size())));
  const Eigen::Matrix4d covariance = information.inverse();
  return {covariance * gradient, excess * covariance};
}

Rigid3 Moved(const Rigid3& site_from_odom, const Eigen::Vector3d& center_in_odom,
             const Eigen::Vector4d& step) {
  const Eigen::Vector3d center = site_from_odom * center_in_odom;
  const Rigid3 turn{ExpSo3({0, 0, step[0]}), Eigen::Vector3d::Zero()};
  return Rigid3{Eigen::Quaterniond::Identity(), center + step.tail<3>()} * turn *
         Rigid3{Eigen::Quaterniond::Identity(), -center} * site_from_odom;
}

double Quantile(std::vector<double> sorted_values, double share) {
  std::sort(sorted_values.begin(), sorted_values.end());
  const double position = share * static_cast<double>(sorted_values.size() - 1);
  return sorted_values[static_cast<size_t>(std::ceil(position))];
}

/// Everything but the datum. `fixes` are those of the pairs.
GnssAlignment Describe(const GnssPairs& pairs, const std::vector<GnssFix>& fixes, RobustFit&& fit,
                       double correlation_time) {
  GnssAlignment alignment;
  const Eigen::Vector3d center_in_odom = pairs.antenna_in_odom * fit.weights / fit.weights.sum();
  for (int round = 0; round < kCorrelatedRounds; ++round) {
    const LinearFit linear = FitCorrelated(pairs, fit, center_in_odom, correlation_time);
    fit.site_from_odom = Moved(fit.site_from_odom, center_in_odom, linear.step);
    alignment.covariance = linear.covariance;
  }
  alignment.site_from_odom = fit.site_from_odom;
  alignment.center_in_odom = center_in_odom;
  const Eigen::Matrix3Xd residuals = Residuals(pairs, fit.site_from_odom);
  const Eigen::VectorXd squared = SquaredErrors(pairs, fit.site_from_odom);
  alignment.num_fixes = static_cast<int>(pairs.size());
  double horizontal = 0, vertical = 0;
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < pairs.size(); ++i) {
    distances.push_back(residuals.col(i).head<2>().norm());
    if (squared[i] > kOutlierSquaredError) {
      alignment.outliers.push_back(fixes[static_cast<size_t>(i)].time);
      continue;
    }
    ++alignment.num_inliers;
    horizontal += residuals.col(i).head<2>().squaredNorm();
    vertical += residuals(2, i) * residuals(2, i);
    alignment.extent = std::max(alignment.extent,
                                (pairs.antenna_in_odom.col(i) - center_in_odom).head<2>().norm());
  }
  const double count = std::max(1, alignment.num_inliers);
  alignment.horizontal_rmse = std::sqrt(horizontal / count);
  alignment.vertical_rmse = std::sqrt(vertical / count);
  alignment.cep50 = Quantile(distances, 0.50);
  alignment.cep95 = Quantile(distances, 0.95);
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
         fix.sigma_enu.head<2>().maxCoeff() <= max_sigma &&
         odom_from_body.span().Contains(fix.time);
}

double GnssAlignment::YawSigma() const { return std::sqrt(covariance(0, 0)); }

SitePlacement PlacementBy(const std::vector<GnssAlignment>& drives) {
  SitePlacement placement;
  const auto center_of = [](const GnssAlignment& drive) {
    return drive.site_from_odom * drive.center_in_odom;
  };
  for (const GnssAlignment& drive : drives)
    placement.center += center_of(drive) / static_cast<double>(drives.size());
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  for (const GnssAlignment& drive : drives) {
    const Eigen::Vector3d arm = center_of(drive) - placement.center;
    Eigen::Matrix4d moved_by =
        Eigen::Matrix4d::Identity();  // d [yaw, x, y, z] at the drive's center / d the site's
    moved_by(1, 0) = -arm.y();
    moved_by(2, 0) = arm.x();
    information += moved_by.transpose() * drive.covariance.inverse() * moved_by;
  }
  placement.covariance = information.inverse();
  return placement;
}

std::optional<GnssAlignment> AlignToGnss(const Trajectory& odom_from_body,
                                         const std::vector<GnssFix>& fixes,
                                         const Eigen::Vector3d& antenna_in_body,
                                         const GnssAlignOptions& options,
                                         const std::optional<SiteDatum>& datum) {
  options.Validate();
  std::vector<GnssFix> usable;
  std::copy_if(fixes.begin(), fixes.end(), std::back_inserter(usable), [&](const GnssFix& fix) {
    return IsUsable(fix, odom_from_body, options.max_fix_sigma);
  });
  if (usable.size() < static_cast<size_t>(kMinInliers)) return std::nullopt;
  std::stable_sort(usable.begin(), usable.end(),
                   [](const GnssFix& a, const GnssFix& b) { return a.time < b.time; });

  const SiteDatum site_datum = datum ? *datum : ChooseDatum(usable);
  const auto make_pairs = [&](double drift) {
    return MakeGnssPairs(odom_from_body, usable, antenna_in_body, site_datum, drift);
  };
  GnssPairs pairs = make_pairs(options.odometry_drift);
  RobustFit fit = FitRobustly(pairs);
  pairs = make_pairs(BendOf(pairs, fit, options.odometry_drift));
  fit = FitRobustly(pairs);
  GnssAlignment alignment = Describe(pairs, usable, std::move(fit), options.correlation_time);
  alignment.datum = site_datum;
  const bool most_agree =
      alignment.num_inliers >= kMinInliers && 2 * alignment.num_inliers >= alignment.num_fixes;
  // Reflections change with the location: within their reach they look like a rotation, whatever
  // the noise averages to.
  std::vector<double> sigmas;
  sigmas.reserve(usable.size());
  for (const GnssFix& fix : usable) sigmas.push_back(fix.sigma_enu.head<2>().maxCoeff());
  if (alignment.extent < kSigmasOfExtent * Median(sigmas)) return std::nullopt;
  if (!most_agree || alignment.YawSigma() > options.max_yaw_sigma) return std::nullopt;
  return alignment;
}

}  // namespace parkade
