#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mapping/markings/slot_row_fit.h"
#include "mapping/markings/slot_row_growth.h"
#include "mapping/markings/slot_row_options.h"

namespace parkade {

/// The lengthwise division of a row: one rank of slots, or two back to back.
struct RowLayout {
  RowEnds lower, upper;
  int count = 1;
  bool is_lower_known = true, is_upper_known = true;
  bool is_length_measured = true;  ///< and not that of other rows

  bool IsSlanted() const;
};

/// How the ends of a row lie whose lines run along a direction.
struct RowSlant {
  Eigen::Vector2d along;
  double slope = 0;  ///< as RowEnds; the same for both senses of `along`
};

/// What the rows of one site have in common.
struct RowHabits {
  double length = 0;             ///< [m] of slots along their lines
  std::vector<RowSlant> slants;  ///< of rows that are sure of theirs
};

/// The ranks of a row that is one; nothing where its lines are something else.
///
/// Ends on both sides are parallel. What the row's own lines do not tell, other rows do: the slant
/// of rows with parallel lines where it explains more ends than the row's own, the usual length
/// where only one side has ends. Ends that are not seen, as no ground is seen behind them, count
/// where many lines have them in common: a wall stands there.
std::optional<RowLayout> FindRowLayout(const SlotRow& row, const SlotMeasures& measures,
                                       bool is_parallel, const RowHabits& habits);

/// Slants of rows with four seen ends on one side; the median length of slots in rows that tell it.
RowHabits FindHabits(const std::vector<SlotRow>& rows, const SlotMeasures& measures,
                     bool is_parallel);

/// A row whose ends many of its lines agree on, and all of them or two whole ones: nothing but
/// paint looks like that.
bool IsBeyondDoubt(const SlotRow& row, const RowLayout& ranks);

}  // namespace parkade
