#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mapping/markings/paint_lines.h"
#include "mapping/markings/slot_row_fit.h"
#include "mapping/markings/slot_row_options.h"

namespace parkade {

/// A group of parallel lines in the frame of the longest of them.
struct SlotRow {
  Eigen::Vector2d origin, along, across;  ///< [m] in site; unit vectors
  double height = 0;
  double pitch = 0;
  std::vector<RowDivider> dividers;  ///< by `across`
  std::vector<std::size_t> members;  ///< lines

  Eigen::Vector2d Place(double along_value, double across_value) const {
    return origin + along_value * along + across_value * across;
  }
};

/// The row that a line is in: neighbors at the pitch that most lines around it have, on both sides
/// until none follows; at most SlotRowOptions::max_missing lines in a row may be missing. Lines
/// that may be edges of something continue a row where no other line does, and never begin one.
/// Nothing without a neighbor. `is_used` are lines of other rows.
std::optional<SlotRow> GrowRow(const std::vector<PaintLine>& lines, std::size_t seed,
                               const SlotMeasures& measures, const SlotRowOptions& options,
                               const std::vector<bool>& is_used);

}  // namespace parkade
