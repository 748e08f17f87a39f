#include "mapping/markings/row_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kMinSeenShare = 0.25;  // of a row's lines whose ends have to agree
constexpr double kMinWallShare = 0.4;   // the same for those that a wall cuts off
constexpr double kSecondRank =
    1.0;  // [m] of paint behind one rank of slots that say that there is another
constexpr int kFewLines = 4;           // seen ones: fewer are a row only where they are whole
constexpr int kSureSlant = 4;          // ends on one side that say what slant parallel rows have
constexpr double kSameDirection = 5;   // [deg]
constexpr double kWhole = 0.7;         // of a slot's length
constexpr double kSquareSlope = 0.08;  // of ends up to which a row is perpendicular

/// [m] between the ends, of a slot's length: where lines stand askew they are longer than that.
double LengthBetween(const RowEnds& lower, const RowEnds& upper, double pitch) {
  return upper.offset - lower.offset - std::abs(lower.slope) * pitch;
}

int CountSeenLines(const SlotRow& row) {
  return static_cast<int>(
      std::count_if(row.dividers.begin(), row.dividers.end(),
                    [](const RowDivider& divider) { return !divider.stretches.empty(); }));
}

int CountRanks(double length, const SlotMeasures& measures) {
  if (length >= measures.min_length && length <= measures.max_length) return 1;
  if (length >= 2 * measures.min_length && length <= measures.LongestLine()) return 2;
  return 0;
}

/// Ends that enough of the row's lines agree on.
std::optional<RowEnds> SureEnds(const SlotRow& row, bool is_lower,
                                std::optional<double> slope = std::nullopt) {
  const std::optional<RowEnds> ends = FitRowEnds(row.dividers, is_lower, slope);
  if (!ends || ends->num_seen < std::max(2.0, kMinSeenShare * CountSeenLines(row))) return {};
  return ends;
}

/// Ends opposite to known ones that are not seen, as no ground is seen behind them, but that many
/// lines have in common: a wall stands there.
std::optional<RowEnds> EndsAtWall(const SlotRow& row, bool is_lower, double slope) {
  const std::optional<RowEnds> ends = FitRowEnds(row.dividers, is_lower, slope, LineEnds::kAll);
  if (!ends || ends->num_seen < std::max(3.0, kMinWallShare * CountSeenLines(row))) return {};
  return ends;
}

/// How many lines go on behind one rank of slots that begins at known ends.
int CountLongerLines(const SlotRow& row, const RowEnds& known, bool is_lower, double length) {
  return static_cast<int>(
      std::count_if(row.dividers.begin(), row.dividers.end(), [&](const RowDivider& divider) {
        const double from = known.At(divider.across) + (is_lower ? length : -length);
        return divider.Support(is_lower ? from : -1e9, is_lower ? 1e9 : from) > kSecondRank;
      }));
}

/// RowLayout of which only the ends on one side are known: the rest is as long as slots of this
/// site are.
RowLayout ContinueFrom(const SlotRow& row, const RowEnds& known, bool is_lower,
                       double usual_length) {
  const double slot = usual_length + std::abs(known.slope) * row.pitch;
  RowLayout ranks;
  ranks.count =
      std::abs(known.slope) < kSquareSlope && CountLongerLines(row, known, is_lower, slot) >= 2 ? 2
                                                                                                : 1;
  ranks.is_lower_known = is_lower, ranks.is_upper_known = !is_lower;
  ranks.is_length_measured = false;
  ranks.lower = is_lower ? known : RowEnds{known.offset - ranks.count * slot, known.slope, 0};
  ranks.upper = is_lower ? RowEnds{known.offset + ranks.count * slot, known.slope, 0} : known;
  return ranks;
}

/// Whether a few lines are enough to be a row: two of them whole, their ends seen.
bool HasWholeLines(const SlotRow& row, const RowLayout& ranks) {
  if (!ranks.is_lower_known || !ranks.is_upper_known) return false;
  return std::count_if(row.dividers.begin(), row.dividers.end(), [&](const RowDivider& divider) {
           const double low = ranks.lower.At(divider.across), high = ranks.upper.At(divider.across);
           return divider.Support(low, high) > kWhole * (high - low);
         }) >= 2;
}

using BothEnds = std::pair<std::optional<RowEnds>, std::optional<RowEnds>>;

int CountSeen(const BothEnds& ends) {
  return (ends.first ? ends.first->num_seen : 0) + (ends.second ? ends.second->num_seen : 0);
}

/// Ends on both sides of a row, as far as they are sure. They are parallel: where one side has a
/// slant of its own, or none that its lines agree on, it is asked again with the other one's.
BothEnds FindBothEnds(const SlotRow& row) {
  std::optional<RowEnds> lower = SureEnds(row, true), upper = SureEnds(row, false);
  if (lower && upper && std::abs(lower->slope - upper->slope) <= 0.02) return {lower, upper};
  if (lower && (!upper || lower->num_seen >= upper->num_seen))
    upper = SureEnds(row, false, lower->slope);
  else if (upper)
    lower = SureEnds(row, true, upper->slope);
  return {lower, upper};
}

/// Also, with the slant of rows whose lines are parallel where that explains more ends.
BothEnds FindBothEnds(const SlotRow& row, const std::vector<RowSlant>& slants) {
  BothEnds best = FindBothEnds(row);
  for (const RowSlant& slant : slants) {
    if (std::abs(slant.along.dot(row.along)) < std::cos(kSameDirection * std::numbers::pi / 180))
      continue;
    const BothEnds ends(SureEnds(row, true, slant.slope), SureEnds(row, false, slant.slope));
    if (CountSeen(ends) > CountSeen(best)) best = ends;
  }
  return best;
}

std::optional<RowLayout> FitRowLayout(const SlotRow& row, const SlotMeasures& measures,
                                      bool is_parallel, const RowHabits& habits) {
  auto [lower, upper] = FindBothEnds(row, habits.slants);
  if (lower && upper) {
    const RowLayout ranks{*lower, *upper,
                          CountRanks(LengthBetween(*lower, *upper, row.pitch), measures)};
    if (ranks.count == 1 || (ranks.count == 2 && !is_parallel)) return ranks;
    if (std::max(lower->num_seen, upper->num_seen) < 3) return {};
    (lower->num_seen >= upper->num_seen ? upper : lower).reset();
  }
  if (!lower && !upper) return {};
  if (const std::optional<RowEnds> wall = EndsAtWall(row, !lower, (lower ? lower : upper)->slope)) {
    RowLayout ranks{lower ? *lower : *wall, upper ? *upper : *wall};
    ranks.is_lower_known = lower.has_value(), ranks.is_upper_known = upper.has_value();
    if (CountRanks(LengthBetween(ranks.lower, ranks.upper, row.pitch), measures) == 1) return ranks;
  }
  if (is_parallel) return {};
  return lower ? ContinueFrom(row, *lower, true, habits.length)
               : ContinueFrom(row, *upper, false, habits.length);
}

}  // namespace

bool RowLayout::IsSlanted() const { return std::abs(lower.slope) > kSquareSlope; }

std::optional<RowLayout> FindRowLayout(const SlotRow& row, const SlotMeasures& measures,
                                       bool is_parallel, const RowHabits& habits) {
  std::optional<RowLayout> ranks = FitRowLayout(row, measures, is_parallel, habits);
  if (ranks && CountSeenLines(row) < kFewLines && !HasWholeLines(row, *ranks)) return {};
  return ranks;
}

bool IsBeyondDoubt(const SlotRow& row, const RowLayout& ranks) {
  const int num_agreeing = std::max(ranks.lower.num_seen, ranks.upper.num_seen);
  return num_agreeing >= kFewLines &&
         (num_agreeing == CountSeenLines(row) || HasWholeLines(row, ranks));
}

RowHabits FindHabits(const std::vector<SlotRow>& rows, const SlotMeasures& measures,
                     bool is_parallel) {
  RowHabits habits{measures.usual_length, {}};
  for (const SlotRow& row : rows) {
    const std::optional<RowLayout> ranks = FindRowLayout(row, measures, is_parallel, habits);
    if (ranks && ranks->IsSlanted() &&
        std::max(ranks->lower.num_seen, ranks->upper.num_seen) >= kSureSlant)
      habits.slants.push_back({row.along, ranks->lower.slope});
  }
  std::vector<double> lengths;
  for (const SlotRow& row : rows)
    if (const std::optional<RowLayout> ranks = FindRowLayout(row, measures, is_parallel, habits))
      if (ranks->is_length_measured)
        lengths.push_back(LengthBetween(ranks->lower, ranks->upper, row.pitch) / ranks->count);
  if (lengths.empty()) return habits;
  habits.length = Median(std::move(lengths));
  return habits;
}

}  // namespace parkade
