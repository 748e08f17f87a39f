#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace parkade {

/// A stretch of paint in the frame of its row: `along` the lines, `across` from line to line.
struct PaintStretch {
  double begin = 0, end = 0;                        ///< [m] along
  double across_begin = 0, across_end = 0;          ///< [m] across at both ends
  bool is_begin_seen = false, is_end_seen = false;  ///< as PaintLine
  double width = 0;                                 ///< [m]

  double Length() const { return end - begin; }
  double Across() const { return 0.5 * (across_begin + across_end); }
};

/// One line between two slots: all that is seen of it.
struct RowDivider {
  double across = 0;                         ///< [m] where the row has it
  std::vector<PaintStretch> stretches = {};  ///< none: it follows from the row

  double Support(double from, double to) const;  ///< [m] of paint within a stretch
  /// [m] where its own paint lies at a place, or where the row has it if there is too little paint
  /// to tell.
  double AcrossAt(double along) const;
};

/// Where the lines of a row end: along = offset + slope * across.
struct RowEnds {
  double offset = 0, slope = 0;
  int num_seen = 0;  ///< lines whose ends agree

  double At(double across) const { return offset + slope * across; }
};

/// Which ends of lines count: where paint ends, or also where no more of a line is seen.
enum class LineEnds { kOfPaint, kAll };

/// The straight line that the ends which agree most lie on; nothing where there is none
/// (`is_lower`: at the begin). Square to the lines unless a slant explains two ends more.
std::optional<RowEnds> FitRowEnds(std::span<const RowDivider> dividers, bool is_lower,
                                  std::optional<double> slope = std::nullopt,
                                  LineEnds which = LineEnds::kOfPaint);

}  // namespace parkade
