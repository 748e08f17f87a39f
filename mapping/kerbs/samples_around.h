#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/ground_patch.h"

namespace parkade {

/// A piece of ground by its corners [m] in site.
using GroundArea = std::array<Eigen::Vector2d, 4>;

/// The samples of a patch by the direction in which the camera sees them, in which they stay at any
/// height.
class SamplesAround {
 public:
  /// `eye` [m] in site: of the camera. Of the samples those are kept that may be asked for, in
  /// directions of the `areas`.
  SamplesAround(const PosedGroundPatch& posed, const Eigen::Vector3d& eye,
                std::span<const GroundArea> areas);

  /// Calls `visit(ray, gray)` with those in directions of an area, one of those named before; with
  /// all where the camera is in it.
  template <typename Visitor>
  void VisitBehind(const GroundArea& area, const Visitor& visit) const {
    ForEachRange(area, [&](float lowest, float highest) {
      const auto end = samples_.begin() + begin_of_[SectorOf(highest) + 1];
      for (auto at = samples_.begin() + begin_of_[SectorOf(lowest)]; at != end; ++at)
        if (at->direction >= lowest && at->direction <= highest) visit(at->ray, at->gray);
    });
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

  /// Azimuths [rad] to all corners, from the first to the last.
  std::pair<double, double> AzimuthsOf(const GroundArea& area) const;

  /// Calls `visit(lowest, highest)` with the directions of an area: one range, or two where it lies
  /// on both sides of the azimuth pi.
  template <typename Visitor>
  void ForEachRange(const GroundArea& area, const Visitor& visit) const {
    const auto [first, last] = AzimuthsOf(area);
    for (const double turn : {-2 * M_PI, 0.0, 2 * M_PI}) {
      const double from = first + turn, to = last + turn;
      if (from > M_PI || to < -M_PI) continue;
      visit(from <= -M_PI ? -2 : DirectionOf(std::cos(from), std::sin(from)),
            to >= M_PI ? 2 : DirectionOf(std::cos(to), std::sin(to)));
    }
  }

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
