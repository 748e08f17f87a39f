#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/paint_lines.h"

namespace parkade {

/// What a slot of one kind may measure.
struct SlotMeasures {
  double min_pitch = 2.1, max_pitch = 3.4;    ///< [m] from line to line, square to them
  double min_length = 4.0, max_length = 6.3;  ///< [m] of a slot along its lines
  double usual_length = 5.0;                  ///< [m] where only one end of the lines is seen anywhere

  /// [m] of a line between slots, of which two may stand behind each other; what is longer bounds something else.
  double LongestLine() const { return 2 * max_length; }

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("min_pitch", min_pitch);
    visit("max_pitch", max_pitch);
    visit("min_length", min_length);
    visit("max_length", max_length);
    visit("usual_length", usual_length);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

struct SlotRowOptions {
  SlotMeasures beside;                           ///< perpendicular and angled ones
  SlotMeasures behind{4.6, 7.4, 1.6, 2.9, 2.0};  ///< parallel ones: their lines are short and far apart
  int max_missing = 2;                           ///< lines that may be hidden or worn off in a row
  double min_confidence = 0.32;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("beside", beside);
    visit("behind", behind);
    visit("max_missing", max_missing);
    visit("min_confidence", min_confidence);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A slot in the plane, before anything is known of who stands in it.
struct PlanarSlot {
  std::array<Eigen::Vector2d, 4> corners;  ///< [m] in site, counter-clockwise
  double height = 0;                       ///< [m] in site, of the lines of its row
  SlotKind kind = SlotKind::kPerpendicular;
  double angle = 0;       ///< [rad] as ParkingSlot
  double confidence = 0;  ///< 0 to 1
  int num_marked_sides = 0;
};

/// Whether the cameras saw bare ground at a place [m] on the deck of a height [m]; empty: nothing is known of that.
using IsBareGround = std::function<bool(const Eigen::Vector2d& place, double height)>;

/// The parking slots that lines bound.
///
/// Lines that are parallel, lie beside each other at one pitch and end on common straight lines are a row; from it
/// follow lines that are hidden beneath parked cars or worn off, and ends that nothing shows. Lines twice as long as a
/// slot are two rows back to back. A slot's corners lie in the middle of its lines, half a line's width before their
/// ends; of lines that stand askew to their row only the stretch that both sides of a slot share counts. Of slots that
/// overlap the surer ones remain. Where bare ground is seen instead of a third of a row's paint, slots beside lines
/// that are not there are none. Lines with an unseen side (PaintLine::is_one_sided) continue a row; alone they are one
/// where four or more end on one straight line, all of them or two whole ones. O(lines^2). Deterministic.
std::vector<PlanarSlot> FindSlotRows(const std::vector<PaintLine>& lines, const SlotRowOptions& options = {},
                                     const IsBareGround& is_bare = {});

}  // namespace parkade
