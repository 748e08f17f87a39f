#include "mapping/markings/slot_row_fit.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

constexpr double kOwnSupport = 2.0;     // [m] of paint from which a line says itself where it lies
constexpr double kEndTolerance = 0.15;  // [m]
constexpr double kMaxSlope = 1.2;       // of ends: 50 degrees
constexpr int kSlantAdvantage = 2;      // ends that a slant has to explain more than a square end,
constexpr int kSureSlant = 4;           // and at least
constexpr double kLonger = 0.5;         // [m] of paint beyond an end that speak against it
constexpr double kFar = 1e6;            // [m]

struct SeenEnd {
  double across = 0, along = 0;
};

/// The outermost end of each line that counts, half its width taken off.
std::vector<SeenEnd> SeenEnds(std::span<const RowDivider> dividers, bool is_lower, LineEnds which) {
  std::vector<SeenEnd> ends;
  for (const RowDivider& divider : dividers) {
    const PaintStretch* outermost = nullptr;
    for (const PaintStretch& stretch : divider.stretches)
      if (outermost == nullptr ||
          (is_lower ? stretch.begin < outermost->begin : stretch.end > outermost->end))
        outermost = &stretch;
    if (outermost == nullptr) continue;
    if (which == LineEnds::kOfPaint &&
        !(is_lower ? outermost->is_begin_seen : outermost->is_end_seen))
      continue;
    ends.push_back(is_lower
                       ? SeenEnd{outermost->across_begin, outermost->begin + 0.5 * outermost->width}
                       : SeenEnd{outermost->across_end, outermost->end - 0.5 * outermost->width});
  }
  return ends;
}

int CountInliers(const std::vector<SeenEnd>& ends, const RowEnds& line) {
  return static_cast<int>(std::count_if(ends.begin(), ends.end(), [&](const SeenEnd& end) {
    return std::abs(end.along - line.At(end.across)) < kEndTolerance;
  }));
}

/// Lines that go on beyond the ends: there they cannot end.
int CountLonger(std::span<const RowDivider> dividers, bool is_lower, const RowEnds& ends) {
  return static_cast<int>(
      std::count_if(dividers.begin(), dividers.end(), [&](const RowDivider& divider) {
        const double end = ends.At(divider.across);
        return divider.Support(is_lower ? -kFar : end, is_lower ? end : kFar) > kLonger;
      }));
}

/// The least squares of the ends near `line`, with its slope kept or not.
RowEnds Refine(const std::vector<SeenEnd>& ends, RowEnds line, bool keeps_slope) {
  for (int round = 0; round < 2; ++round) {
    double count = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
    for (const SeenEnd& end : ends) {
      if (std::abs(end.along - line.At(end.across)) >= kEndTolerance) continue;
      count += 1, sum_x += end.across, sum_y += end.along;
      sum_xx += end.across * end.across, sum_xy += end.across * end.along;
    }
    if (count == 0) break;
    const double determinant = count * sum_xx - sum_x * sum_x;
    if (!keeps_slope && count >= 4 && determinant > 1e-6)
      line.slope = (count * sum_xy - sum_x * sum_y) / determinant;
    line.offset = (sum_y - line.slope * sum_x) / count;
    line.num_seen = static_cast<int>(count);
  }
  return line;
}

}  // namespace

double RowDivider::Support(double from, double to) const {
  double support = 0;
  for (const PaintStretch& stretch : stretches)
    support += std::max(0.0, std::min(to, stretch.end) - std::max(from, stretch.begin));
  return support;
}

double RowDivider::AcrossAt(double along) const {
  double weight = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  for (const PaintStretch& stretch : stretches) {
    const double length = stretch.Length();
    for (const auto& [x, y] :
         {std::pair(stretch.begin, stretch.across_begin), {stretch.end, stretch.across_end}}) {
      weight += length, sum_x += length * x, sum_y += length * y;
      sum_xx += length * x * x, sum_xy += length * x * y;
    }
  }
  if (!(weight > 0)) return across;
  const double mean_x = sum_x / weight, mean_y = sum_y / weight,
               variance = sum_xx / weight - mean_x * mean_x;
  // The ends of one line of this length have a variance of a quarter of its square.
  if (2 * std::sqrt(variance) < kOwnSupport) return mean_y;
  return mean_y + (sum_xy / weight - mean_x * mean_y) / variance * (along - mean_x);
}

std::optional<RowEnds> FitRowEnds(std::span<const RowDivider> dividers, bool is_lower,
                                  std::optional<double> slope, LineEnds which) {
  const std::vector<SeenEnd> ends = SeenEnds(dividers, is_lower, which);
  RowEnds best;
  int best_score = 0, best_handicap = 0;
  const auto consider = [&](double line_slope, const SeenEnd& through, int handicap) {
    RowEnds line{through.along - line_slope * through.across, line_slope, 0};
    line.num_seen = CountInliers(ends, line);
    const int score = line.num_seen - CountLonger(dividers, is_lower, line) - handicap;
    const bool is_outer = is_lower ? line.offset < best.offset : line.offset > best.offset;
    const bool is_equal = score == best_score && score > 0;
    const bool is_better =
        handicap == 0 ? is_outer : best_handicap == 0 && line.num_seen >= kSureSlant;
    if (score > best_score || (is_equal && is_better))
      best = line, best_score = score, best_handicap = handicap;
  };
  for (const SeenEnd& end : ends) consider(slope.value_or(0), end, 0);
  if (!slope)
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t k = i + 1; k < ends.size(); ++k) {
        const double run = ends[k].across - ends[i].across;
        if (std::abs(run) < 1) continue;
        const double pair_slope = (ends[k].along - ends[i].along) / run;
        if (std::abs(pair_slope) < kMaxSlope) consider(pair_slope, ends[i], kSlantAdvantage);
      }
  if (best_score <= 0) return {};
  return Refine(ends, best, slope.has_value());
}

}  // namespace parkade
