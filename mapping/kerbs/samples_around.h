#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
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
    const auto [first, last] = Between(places);
    for (const double turn : {-2 * M_PI, 0.0, 2 * M_PI}) {
      const double from = first + turn, to = last + turn;
      if (from > M_PI || to < -M_PI) continue;
      const float lowest = from <= -M_PI ? -2 : DirectionOf(std::cos(from), std::sin(from));
      const float highest = to >= M_PI ? 2 : DirectionOf(std::cos(to), std::sin(to));
      const auto end = samples_.begin() + begin_of_[SectorOf(highest) + 1];
      for (auto at = samples_.begin() + begin_of_[SectorOf(lowest)]; at != end; ++at)
        if (at->direction >= lowest && at->direction <= highest) visit(at->ray, at->gray);
    }
  }

 private:
  static constexpr std::size_t kNumSectors = 1024;

  /// -2 to 2: grows with the azimuth from -pi to pi, without an arc tangent.
  static float DirectionOf(double x, double y) {
    const double sine = y / (std::abs(x) + std::abs(y));  // of a circle that is a square
    return static_cast<float>(x >= 0 ? sine : std::copysign(2.0, y) - sine);
  }
  static std::size_t SectorOf(float direction) {
    constexpr float kPerUnit = kNumSectors / 4.0F;
    const float sector = (direction + 2) * kPerUnit;
    return sector > 0 ? std::min(static_cast<std::size_t>(sector), kNumSectors - 1) : 0;
  }

  /// Directions [rad] to all places, from the first to the last.
  std::pair<double, double> Between(std::span<const Eigen::Vector2d> places) const;

  struct Sample {
    float direction = 0;
    Eigen::Vector3f ray;  ///< [m] from the eye
    float gray = 0;
  };

  Eigen::Vector3d eye_;
  std::vector<Sample> samples_;           ///< by sector
  std::vector<std::ptrdiff_t> begin_of_;  ///< each sector's first, and the end
};

}  // namespace parkade
