#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geo.h"
#include "core/ground_markings.h"
#include "export/free_space.h"

namespace parkade {

/// A parking slot and what it is called.
struct NamedSlot {
  std::string name;
  ParkingSlot slot;
};

/// What of a finished map goes into Lanelet2; all in site.
struct ParkingMap {
  std::vector<FreeSheet> sheets = {};
  double cell_size = 0.1;  ///< [m] of the surface that the sheets are of
  std::vector<NamedSlot> slots = {};
  std::vector<Kerb> kerbs = {};
};

/// lanelet2_map.osm, as Autoware's freespace planner and costmap generator read it
/// (autoware_lanelet2_extension; Lanelet2, LinestringTagging.md):
///   parking_lot    polygon: free ground with its slots (FindParkingLots). Polygons of Lanelet2
///   have
///                  no holes, so what a lot encloses is an
///   obstacle       polygon. Autoware takes it out of the lots by `use_lanelet_obstacles` of its
///                  costmap generator.
///   parking_space  line of two nodes along the slot's middle, from the entrance inwards, with
///                  `width` [m]; in a slot parallel to its lane with that lane on the left. `name`
///                  is the slot's. It lies in one lot of its level.
///   curbstone      line along a kerb's foot, the drivable ground on the left, with `height` [m]:
///                  `low` up to 6 cm, which a car drives over, else `high`.
/// All have a tag `level`. Autoware's queries look from above and do not read it: of decks above
/// each other, load one at a time (`level`). There are no lanelets: which way cars go, a map of the
/// ground does not say.
///
/// \param datum  see MapProjector
/// \param level  only this one, where given
/// Throws Error{kInvalidInput} where the map has neither free ground nor slots, Error{kUsage}
/// naming the levels where it has no such one.
std::string EncodeLanelet2(const ParkingMap& map, const std::optional<SiteDatum>& datum,
                           std::optional<int> level = {});

}  // namespace parkade
