#pragma once

#include <vector>

#include "mapping/markings/paint_lines.h"
#include "mapping/markings/planar_slot.h"
#include "mapping/markings/slot_row_options.h"

namespace parkade {

/// The parking slots that lines bound.
///
/// Lines that are parallel, lie beside each other at one pitch and end on common straight lines are
/// a row; from it follow lines that are hidden beneath parked cars or worn off, and ends that
/// nothing shows. Lines twice as long as a slot are two rows back to back. A slot's corners lie in
/// the middle of its lines, half a line's width before their ends; of lines that stand askew to
/// their row only the stretch that both sides of a slot share counts. Of slots that overlap the
/// surer ones remain. Where bare ground is seen instead of a third of a row's paint, slots beside
/// lines that are not there are none. Lines with an unseen side (PaintLine::is_one_sided) continue
/// a row; alone they are one where four or more end on one straight line, all of them or two whole
/// ones. Where corners alone are painted, see FindSlotsAtMarks. O(lines^2). Deterministic.
std::vector<PlanarSlot> FindSlotRows(const std::vector<PaintLine>& lines,
                                     const SlotRowOptions& options = {},
                                     const IsBareGround& is_bare = {});

}  // namespace parkade
