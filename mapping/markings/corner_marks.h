#pragma once

#include <vector>

#include "mapping/markings/paint_lines.h"
#include "mapping/markings/planar_slot.h"
#include "mapping/markings/slot_row_options.h"

namespace parkade {

/// Slots of which only corners are painted: as a T between two neighbors, a bar along the aisle and
/// a stem into the row, or as angles. Three marks or more in line, turned alike, at one pitch are a
/// row, perpendicular (SlotRowOptions::beside) or parallel (behind); of a slot that stands apart
/// from its neighbors, marks at both sides count once. Marks tell where slots begin and how wide
/// they are; they are as deep as is usual. A mark that is not seen follows from the row; where
/// two side by side are not, and bare ground is, there is a way through.
/// O(lines * lines nearby + marks^2). Deterministic.
/// \param is_used       lines of other rows
/// \param usual_length  [m] of perpendicular slots
std::vector<PlanarSlot> FindSlotsAtMarks(const std::vector<PaintLine>& lines,
                                         const std::vector<bool>& is_used, double usual_length,
                                         const SlotRowOptions& options,
                                         const IsBareGround& is_bare = {});

}  // namespace parkade
