#include "slam/georeference/fit_pins.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "core/error.h"
#include "slam/georeference/align_points.h"

namespace parkade {
namespace {

constexpr double kLowest = -1000, kHighest = 10000;  // [m] of roads on Earth

std::string Meters(double meters) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f m", meters);
  return text;
}

std::string NumberOf(size_t pin) { return "pin " + std::to_string(pin + 1); }

void RequirePlace(const PinnedPoint& pin, size_t number) {
  Require(pin.point_in_site.allFinite(), ErrorCode::kInvalidInput,
          NumberOf(number) + " is no point of the site");
  Require(std::abs(pin.latitude_deg) < 90, ErrorCode::kInvalidInput,
          "the latitude of " + NumberOf(number) + " must be between -90 and 90 degrees");
  Require(std::abs(pin.longitude_deg) <= 180, ErrorCode::kInvalidInput,
          "the longitude of " + NumberOf(number) + " must be between -180 and 180 degrees");
  Require(!pin.height || (*pin.height >= kLowest && *pin.height <= kHighest),
          ErrorCode::kInvalidInput,
          "the height of " + NumberOf(number) + " must be between -1000 and 10000 m");
}

/// The largest horizontal distance of two columns.
double SpreadOf(const Eigen::Matrix3Xd& points) {
  double spread = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (Eigen::Index k = 0; k < i; ++k)
      spread = std::max(spread, (points.col(i) - points.col(k)).head<2>().norm());
  return spread;
}

SiteDatum DatumAt(const std::vector<PinnedPoint>& pins, const std::optional<SiteDatum>& placed) {
  SiteDatum datum{pins.front().latitude_deg, pins.front().longitude_deg, 0, false};
  const auto highest =
      std::find_if(pins.begin(), pins.end(), [](const PinnedPoint& pin) { return pin.height; });
  if (highest != pins.end()) {
    datum.altitude = *highest->height;
    datum.is_altitude_known = true;
  } else if (placed && placed->is_altitude_known) {
    datum.altitude = GeodeticFromSite(*placed, pins.front().point_in_site).altitude;
    datum.is_altitude_known = true;
  }
  return datum;
}

double Square(double x) { return x * x; }

/// Covariance of [yaw, x, y, z] at the pins' center.
Eigen::Matrix4d CovarianceOf(const Eigen::Matrix3Xd& target, const Eigen::ArrayXd& has_height,
                             const PinFit& fit, double sigma, double placed_variance) {
  double horizontal = 0, vertical = 0;
  for (const Eigen::Vector3d& residual : fit.residuals) {
    horizontal += residual.head<2>().squaredNorm();
    vertical += Square(residual.z());
  }
  const auto count = static_cast<double>(target.cols());
  const double num_heights = has_height.sum();
  const double variance = std::max(Square(sigma), horizontal / (2 * count - 3));
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  covariance(0, 0) =
      variance / (target.colwise() - fit.placement.center).topRows<2>().squaredNorm();
  covariance(1, 1) = covariance(2, 2) = variance / count;
  if (num_heights > 0) {
    covariance(3, 3) =
        std::max(Square(sigma), vertical / std::max(1.0, num_heights - 1)) / num_heights;
  } else {
    covariance(3, 3) =
        fit.datum.is_altitude_known ? placed_variance : std::numeric_limits<double>::infinity();
  }
  return covariance;
}

}  // namespace

void PinOptions::Validate() const {
  Require(sigma > 0 && tolerance > 0 && min_distance > 0, ErrorCode::kUsage,
          "sigma, tolerance and min_distance of pins must be > 0 m");
}

size_t PinFit::WorstPin() const {
  const auto is_less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.norm() < b.norm();
  };
  return static_cast<size_t>(std::max_element(residuals.begin(), residuals.end(), is_less) -
                             residuals.begin());
}

PinFit FitPins(const std::vector<PinnedPoint>& pins, const PinOptions& options,
               const std::optional<SiteDatum>& placed, double placed_variance) {
  options.Validate();
  for (size_t i = 0; i < pins.size(); ++i) RequirePlace(pins[i], i);
  Require(pins.size() >= 2, ErrorCode::kInvalidInput,
          "a site is pinned by two points or more: one gives no heading");
  PinFit fit;
  fit.datum = DatumAt(pins, placed);
  const auto count = static_cast<Eigen::Index>(pins.size());
  Eigen::Matrix3Xd source(3, count), target(3, count);
  Eigen::ArrayXd has_height(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const PinnedPoint& pin = pins[static_cast<size_t>(i)];
    source.col(i) = pin.point_in_site;
    target.col(i) = SiteFromGeodetic(fit.datum, pin.latitude_deg, pin.longitude_deg,
                                     pin.height.value_or(fit.datum.altitude));
    has_height[i] = pin.height ? 1 : 0;
  }
  for (const double spread : {SpreadOf(source), SpreadOf(target)})
    Require(spread >= options.min_distance, ErrorCode::kInvalidInput,
            "the pins lie within " + Meters(spread) + " of each other; two of them must be " +
                Meters(options.min_distance) + " apart or more, for a heading");
  // Without heights the first pin is where the datum is.
  Eigen::VectorXd vertical = has_height;
  if (has_height.sum() == 0) vertical[0] = 1;
  fit.pinned_from_site =
      AlignYawAndTranslation(source, target, Eigen::VectorXd::Ones(count), vertical);
  for (Eigen::Index i = 0; i < count; ++i) {
    Eigen::Vector3d residual =
        target.col(i) - fit.pinned_from_site * Eigen::Vector3d(source.col(i));
    if (has_height[i] == 0) residual.z() = 0;
    fit.residuals.push_back(residual);
  }
  fit.placement.center = fit.pinned_from_site * Eigen::Vector3d(source.rowwise().mean());
  fit.placement.covariance = CovarianceOf(target, has_height, fit, options.sigma, placed_variance);
  return fit;
}

void RequireAgreement(const PinFit& fit, const PinOptions& options) {
  const size_t worst = fit.WorstPin();
  const double error = fit.residuals[worst].norm();
  Require(error <= options.tolerance, ErrorCode::kInvalidInput,
          "the pins do not fit each other: " + NumberOf(worst) + " lies " + Meters(error) +
              " from where all of them put it, and " + Meters(options.tolerance) +
              " is allowed (pins.tolerance)");
}

}  // namespace parkade
