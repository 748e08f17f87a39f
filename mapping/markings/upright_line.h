#pragma once

namespace parkade {

/// A nearly upright line; columns and rows count from the middle of the upper left pixel.
struct AxisAlignedLine {
  double column_at_zero = 0, slope = 0;  ///< column = column_at_zero + slope * row
  double first_row = 0, last_row = 0;
  double width = 0;     ///< [pixels]
  double contrast = 0;  ///< against its sides, of their brightness
  bool is_first_seen = false, is_last_seen = false;
  bool is_one_sided = false;  ///< most of it has not sure ground on both sides

  double ColumnAt(double row) const { return column_at_zero + slope * row; }
};

}  // namespace parkade
