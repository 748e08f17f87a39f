#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/markings/paint_lines.h"
#include "mapping/markings/slot_row_options.h"

namespace parkade {

/// A slot in the plane, before anything is known of who stands in it.
struct PlanarSlot {
  std::array<Eigen::Vector2d, 4> corners;  ///< [m] in site, counter-clockwise
  double height = 0;                       ///< [m] in site, of the lines of its row
  SlotKind kind = SlotKind::kPerpendicular;
  double angle = 0;       ///< [rad] as ParkingSlot
  double confidence = 0;  ///< 0 to 1
  int num_marked_sides = 0;
};

/// Whether the cameras saw bare ground at a place [m] on the deck of a height [m]; empty: nothing
/// is known of that.
using IsBareGround = std::function<bool(const Eigen::Vector2d& place, double height)>;

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
