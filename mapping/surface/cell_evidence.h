#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/surface_class.h"
#include "mapping/surface/cell_color.h"
#include "mapping/surface/observation_summary.h"

namespace parkade {

inline constexpr float kLogOddsLimit = 8;  ///< of one drive, and of all drives together

/// Directions and distances from which a cell was looked at: a bit each.
using ViewSet = std::uint32_t;

/// The one of them that looks from `eye` at a point.
ViewSet ViewFrom(const Eigen::Vector3d& eye, const Eigen::Vector3d& point);

/// What a sample tells of a cell.
struct CellObservation {
  ColorObservation color;
  float log_odds = 0;
  ViewSet view = 0;  ///< one bit, or none where it is not known well enough
  SurfaceClass surface = SurfaceClass::kUnknown;
};

/// What one drive shows of a cell, for and against drivable ground.
struct ShownCell {
  float log_odds = 0;            ///< as CellEvidence has them
  float free = 0, occupied = 0;  ///< sums of log-odds
  ViewSet free_views = 0, occupied_views = 0;
};

/// What is known of a cell.
struct CellEvidence {
  float log_odds = 0;      ///< of the drives before this one
  float log_odds_now = 0;  ///< of this drive
  bool is_driven = false;
  bool is_hit = false;    ///< in this drive
  ViewSet seen_from = 0;  ///< in earlier drives, as free ground
  ShownCell shown;        ///< by the latest of the drives before that told of the cell: by all of
                          ///< them, parked cars of other days would make it look doubtful
  ShownCell shown_now;    ///< by this drive
  CellColor observations;
  std::array<float, kNumSurfaceClasses> classes{};  ///< weights of what images show

  bool IsKnown() const { return is_driven || !observations.empty(); }

  void Count(const CellObservation& observation) {
    log_odds_now = std::clamp(log_odds_now + observation.log_odds, -kLogOddsLimit, kLogOddsLimit);
    const bool is_free = observation.log_odds > 0;
    (is_free ? shown_now.free_views : shown_now.occupied_views) |= observation.view;
    (is_free ? shown_now.free : shown_now.occupied) += std::abs(observation.log_odds);
    if (observation.surface != SurfaceClass::kUnknown)
      classes[static_cast<std::size_t>(observation.surface)] += std::abs(observation.log_odds);
    if (observation.color.rank > 0)
      observations.Add(observation.color, /*is_first=*/!std::exchange(is_hit, true));
  }

  /// What the drive saw joins what those before it did.
  void EndDrive();

  ObservationSummary Summary() const;
  /// See SurfaceCell.
  std::array<std::uint8_t, kNumSurfaceClasses> ClassBeliefs() const;
};

}  // namespace parkade
