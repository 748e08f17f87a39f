#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geo.h"
#include "core/option_about.h"

namespace parkade {

struct PinOptions {
  double sigma =
      0.2;  ///< [m] how well a pin is known, per axis; residuals that are larger count instead
  double tolerance = 1.0;     ///< [m] pins that err by more do not fit each other
  double min_distance = 5.0;  ///< [m] that two pins at least must lie apart, for a heading

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("sigma", sigma, OptionAbout{"A pin is this sure (one sigma).", "m", 0.001, 100});
    visit("tolerance", tolerance,
          OptionAbout{"Pins that miss each other by more do not fit.", "m", 0.001, 1000});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A point of a site whose position on Earth is known.
struct PinnedPoint {
  Eigen::Vector3d point_in_site = Eigen::Vector3d::Zero();  ///< [m]
  double latitude_deg = 0, longitude_deg = 0;
  std::optional<double> height;  ///< [m] above the ellipsoid
};

/// The motion that puts a site where its pins say.
struct PinFit {
  SiteDatum datum;  ///< at the first pin
  Rigid3 pinned_from_site;
  SitePlacement placement;  ///< in the pinned site; z's variance is infinite where nobody said how
                            ///< high it lies
  /// [m] of each pin, in the pinned site: where it says, from where the fit puts it; z is 0 for one
  /// without a height.
  std::vector<Eigen::Vector3d> residuals;

  size_t WorstPin() const;
};

/// Yaw and translation by least squares, each pin counting alike; heights apart from that, from the
/// pins that have one. Where none has, the site keeps the height that `placed` gives it on Earth;
/// without that its altitude is unknown. The covariance is that of pins known to options.sigma, or
/// to what the residuals say where they are larger.
///
/// \param placed            where the site lies by other means
/// \param placed_variance   [m^2] of its height
/// Throws Error{kInvalidInput} for fewer than two pins, coordinates that are not on Earth, or pins
/// that lie together.
PinFit FitPins(const std::vector<PinnedPoint>& pins, const PinOptions& options,
               const std::optional<SiteDatum>& placed = std::nullopt, double placed_variance = 0);

/// Throws Error{kInvalidInput} naming the worst pin where pins err by more than the tolerance.
void RequireAgreement(const PinFit& fit, const PinOptions& options);

}  // namespace parkade
