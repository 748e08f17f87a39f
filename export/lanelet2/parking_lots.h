#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "export/free_space.h"

namespace parkade {

/// A closed line on one level; counter-clockwise from above, simple, [m] in site.
struct LevelRing {
  int level = 0;
  Ring ring;
};

/// Where to drive and park, for readers whose polygons have no holes.
struct ParkingLots {
  std::vector<LevelRing> lots;       ///< free ground with its slots, holes filled
  std::vector<LevelRing> obstacles;  ///< the holes of the lots, in parts that have none
};

/// Lots and obstacles of all levels. Per level:
///   * Each slot belongs to the sheet that most of it lies on and is part of its lot as a whole, be
///     it free or not: it lies in this lot alone. One that lies on none is a lot of its own.
///   * A lot that another one encloses is a part of that one, which no obstacle covers.
///   * What a lot encloses and is in no lot is an obstacle.
///   * Corners are left out by which lots lose and obstacles gain up to `cell_size`: unseen ground
///     is not free. Where two lots meet, as in a ramp that is cut into levels, all corners stay.
/// Lots of less than 1 m^2 without a slot are left out. The order is that of levels and sheets.
/// \param cell_size  [m], of the surface that the sheets are of
ParkingLots FindParkingLots(std::span<const FreeSheet> sheets, std::span<const ParkingSlot> slots,
                            double cell_size);

}  // namespace parkade
