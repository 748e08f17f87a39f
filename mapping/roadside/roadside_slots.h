#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/ground/cell_finder.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/quadrilateral.h"

namespace parkade {

/// A slot beside a street that no line bounds.
struct RoadsideSlot {
  Quadrilateral corners;  ///< [m] in site, counter-clockwise; the last two at the kerb
  double height = 0;      ///< [m] in site
  double confidence = 0;  ///< 0 to 1
  bool is_occupied = false;
};

/// Whether paint says where a slot is; else cars along a kerb do.
inline bool IsMarked(const ParkingSlot& slot) {
  return slot.kind != SlotKind::kParallel || slot.num_marked_sides > 0;
}

/// The parallel slots along kerbs beside which cars drove: see FindParkingLane, FindLaneSlots. Of
/// slots that several passes find the surer one stays. O(length of the paths + slots^2). In
/// parallel, the same every time.
std::vector<RoadsideSlot> FindRoadsideSlots(const CellFinder& cells,
                                            std::span<const DrivenPath> paths);

}  // namespace parkade
