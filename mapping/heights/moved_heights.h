#pragma once

#include "core/trajectory.h"
#include "mapping/heights/drive_heights.h"
#include "mapping/heights/ground_squares.h"

namespace parkade {

/// What heights of a drive are worth after its path moved.
enum class HeightsWorth {
  kHold,  ///< all of them hold
  kSome,  ///< some do: MeasureMovedHeights mends the others
  kNone,
};

struct MovedHeights {
  HeightsWorth worth = HeightsWorth::kNone;
  GroundSquares squares;  ///< in which some do not hold
};

/// Holds each height against the path along which it was measured (PathAgreement), so that small
/// moves do not add up, and places where none was measured against the last path. \param now  in
/// the same frame as before, but for moves
MovedHeights FindMovedHeights(const DriveHeights& heights, const Trajectory& now,
                              const HeightOptions& options);

}  // namespace parkade
