#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/ground_patch.h"

namespace parkade {

/// The samples of a patch by the direction in which the camera sees them, in which they stay at any
/// height.
class SamplesAround {
 public:
  /// `eye` [m] in site: of the camera.
  SamplesAround(const PosedGroundPatch& posed, const Eigen::Vector3d& eye);

  /// Calls `visit(ray, gray)` with those in directions between those to some places; with all where
  /// the camera is among these.
  template <typename Visitor>
  void VisitBetween(std::span<const Eigen::Vector2d> places, const Visitor& visit) const {
    const auto [from, to] = Between(places);
    for (const double turn : {-2 * M_PI, 0.0, 2 * M_PI}) {
      auto at = std::lower_bound(
          samples_.begin(), samples_.end(), from + turn,
          [](const Sample& sample, double azimuth) { return sample.azimuth < azimuth; });
      for (; at != samples_.end() && at->azimuth <= to + turn; ++at) visit(at->ray, at->gray);
    }
  }

 private:
  /// Directions [rad] to all places, from the first to the last.
  std::pair<double, double> Between(std::span<const Eigen::Vector2d> places) const;

  struct Sample {
    double azimuth = 0;   ///< [rad]
    Eigen::Vector3f ray;  ///< [m] from the eye
    float gray = 0;
  };

  Eigen::Vector3d eye_;
  std::vector<Sample> samples_;
};

}  // namespace parkade
