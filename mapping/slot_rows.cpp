#include "mapping/slot_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/error.h"
#include "mapping/quadrilateral.h"
#include "mapping/slot_row_fit.h"
#include "mapping/slot_row_growth.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr double kMaxHeightStep = 1.2;  // [m] between lines of one deck
constexpr double kMinSeenShare = 0.25;  // of a row's lines whose ends have to agree
constexpr double kMinWallShare = 0.4;   // likewise, of those that a wall cuts off
constexpr double kSecondRank = 1.0;     // [m] of paint behind one rank of slots that say that there is another
constexpr int kFewLines = 4;            // seen ones: fewer are a row only where they are whole
constexpr double kWhole = 0.7;          // of a slot's length
constexpr double kMaxEdgeWidth = 0.2;   // [m] of what has an unseen side and may be paint all the same ...
constexpr double kMinEdgeContrast = 0.12;
constexpr double kMarkedShare = 0.12;   // of a side's length from which it counts as seen
constexpr double kSquareSlope = 0.08;   // of ends up to which a row is perpendicular
constexpr double kBareStep = 0.2;       // [m] along lines that may be missing
constexpr double kWornShare = 1.0 / 3;  // of a row's paint that may have worn off
constexpr double kMaxShare = 0.25;      // of a slot that a surer one may cover

/// The lengthwise division of a row: one rank of slots, or two back to back.
struct Ranks {
  RowEnds lower, upper;
  int count = 1;
  bool is_lower_known = true, is_upper_known = true;
  bool is_length_measured = true;  ///< and not that of other rows
};

/// [m] between the ends, of a slot's length: where lines stand askew they are longer than that.
double LengthBetween(const RowEnds& lower, const RowEnds& upper, double pitch) {
  return upper.offset - lower.offset - std::abs(lower.slope) * pitch;
}

int CountRanks(double length, const SlotMeasures& measures) {
  if (length >= measures.min_length && length <= measures.max_length) return 1;
  if (length >= 2 * measures.min_length && length <= measures.LongestLine()) return 2;
  return 0;
}

int CountSeenLines(const SlotRow& row) {
  return static_cast<int>(std::count_if(row.dividers.begin(), row.dividers.end(),
                                        [](const RowDivider& divider) { return !divider.stretches.empty(); }));
}

/// Ends that enough of the row's lines agree on.
std::optional<RowEnds> SureEnds(const SlotRow& row, bool is_lower, std::optional<double> slope = std::nullopt) {
  const std::optional<RowEnds> ends = FitRowEnds(row.dividers, is_lower, slope);
  if (!ends || ends->num_seen < std::max(2.0, kMinSeenShare * CountSeenLines(row))) return {};
  return ends;
}

/// Ends opposite to known ones that are not seen, as no ground is seen behind them, but that many lines have in common:
/// a wall stands there.
std::optional<RowEnds> EndsAtWall(const SlotRow& row, bool is_lower, double slope) {
  const std::optional<RowEnds> ends = FitRowEnds(row.dividers, is_lower, slope, LineEnds::kAll);
  if (!ends || ends->num_seen < std::max(3.0, kMinWallShare * CountSeenLines(row))) return {};
  return ends;
}

/// How many lines go on behind one rank of slots that begins at known ends.
int CountLongerLines(const SlotRow& row, const RowEnds& known, bool is_lower, double length) {
  return static_cast<int>(std::count_if(row.dividers.begin(), row.dividers.end(), [&](const RowDivider& divider) {
    const double from = known.At(divider.across) + (is_lower ? length : -length);
    return divider.Support(is_lower ? from : -1e9, is_lower ? 1e9 : from) > kSecondRank;
  }));
}

/// Ranks of which only the ends on one side are known: the rest is as long as slots of this site are.
Ranks ContinueFrom(const SlotRow& row, const RowEnds& known, bool is_lower, double usual_length) {
  const double slot = usual_length + std::abs(known.slope) * row.pitch;
  Ranks ranks;
  ranks.count = std::abs(known.slope) < kSquareSlope && CountLongerLines(row, known, is_lower, slot) >= 2 ? 2 : 1;
  ranks.is_lower_known = is_lower, ranks.is_upper_known = !is_lower;
  ranks.is_length_measured = false;
  ranks.lower = is_lower ? known : RowEnds{known.offset - ranks.count * slot, known.slope, 0};
  ranks.upper = is_lower ? RowEnds{known.offset + ranks.count * slot, known.slope, 0} : known;
  return ranks;
}

/// Whether a few lines are enough to be a row: two of them whole, their ends seen.
bool HasWholeLines(const SlotRow& row, const Ranks& ranks) {
  if (!ranks.is_lower_known || !ranks.is_upper_known) return false;
  return std::count_if(row.dividers.begin(), row.dividers.end(), [&](const RowDivider& divider) {
           const double low = ranks.lower.At(divider.across), high = ranks.upper.At(divider.across);
           return divider.Support(low, high) > kWhole * (high - low);
         }) >= 2;
}

/// Ends on both sides of a row, as far as they are sure. They are parallel: where one side has a slant of its own, or
/// none that its lines agree on, it is asked again with the other one's.
std::pair<std::optional<RowEnds>, std::optional<RowEnds>> SureEndsOnBothSides(const SlotRow& row) {
  std::optional<RowEnds> lower = SureEnds(row, true), upper = SureEnds(row, false);
  if (lower && upper && std::abs(lower->slope - upper->slope) <= 0.02) return {lower, upper};
  if (lower && (!upper || lower->num_seen >= upper->num_seen))
    upper = SureEnds(row, false, lower->slope);
  else if (upper)
    lower = SureEnds(row, true, upper->slope);
  return {lower, upper};
}

std::optional<Ranks> FitRanks(const SlotRow& row, const SlotMeasures& measures, bool is_parallel, double usual_length) {
  auto [lower, upper] = SureEndsOnBothSides(row);
  if (lower && upper) {
    const Ranks ranks{*lower, *upper, CountRanks(LengthBetween(*lower, *upper, row.pitch), measures)};
    if (ranks.count == 1 || (ranks.count == 2 && !is_parallel)) return ranks;
    if (std::max(lower->num_seen, upper->num_seen) < 3) return {};
    (lower->num_seen >= upper->num_seen ? upper : lower).reset();
  }
  if (is_parallel || (!lower && !upper)) return {};
  if (const std::optional<RowEnds> wall = EndsAtWall(row, !lower, (lower ? lower : upper)->slope)) {
    Ranks ranks{lower ? *lower : *wall, upper ? *upper : *wall};
    ranks.is_lower_known = lower.has_value(), ranks.is_upper_known = upper.has_value();
    if (CountRanks(LengthBetween(ranks.lower, ranks.upper, row.pitch), measures) == 1) return ranks;
  }
  return lower ? ContinueFrom(row, *lower, true, usual_length) : ContinueFrom(row, *upper, false, usual_length);
}

/// The ranks of a row that is one; nothing where its lines are something else.
std::optional<Ranks> FindRanks(const SlotRow& row, const SlotMeasures& measures, bool is_parallel,
                               double usual_length) {
  std::optional<Ranks> ranks = FitRanks(row, measures, is_parallel, usual_length);
  if (ranks && CountSeenLines(row) < kFewLines && !HasWholeLines(row, *ranks)) return {};
  return ranks;
}

/// What is seen where a line should be.
struct SeenLine {
  double painted = 0, bare = 0;  ///< [m]

  bool IsBare() const { return bare > painted; }
};

/// What is seen of one line of a row between two places along it.
SeenLine SeeLine(const SlotRow& row, const RowDivider& divider, double from, double to, const IsBareGround& is_bare) {
  SeenLine seen;
  for (double along = from + kBareStep / 2; along < to; along += kBareStep)
    if (divider.Support(along - kBareStep / 2, along + kBareStep / 2) > 0)
      seen.painted += kBareStep;
    else if (is_bare && is_bare(row.Place(along, divider.AcrossAt(along)), row.height))
      seen.bare += kBareStep;
  return seen;
}

/// Whether so much bare ground is seen where a row's lines should be that single ones are not just worn off.
bool HasBareLines(const SlotRow& row, const Ranks& ranks, const IsBareGround& is_bare) {
  SeenLine sum;
  for (const RowDivider& divider : row.dividers) {
    const SeenLine seen =
        SeeLine(row, divider, ranks.lower.At(divider.across), ranks.upper.At(divider.across), is_bare);
    sum.painted += seen.painted, sum.bare += seen.bare;
  }
  return sum.bare > kWornShare * sum.painted;
}

double ConfidenceOf(double left_share, double right_share, const Ranks& ranks, std::size_t num_dividers) {
  const double ends = ranks.is_lower_known && ranks.is_upper_known ? 1 : 0.5;
  const double company = std::min(1.0, static_cast<double>(num_dividers) / 4);
  return std::min(
      1.0, 0.35 * std::min(1.0, 1.3 * left_share) + 0.35 * std::min(1.0, 1.3 * right_share) + 0.3 * ends * company);
}

/// The slot between two neighbouring dividers, in one of the ranks.
PlanarSlot MakeSlot(const SlotRow& row, const Ranks& ranks, int rank, const RowDivider& left, const RowDivider& right,
                    bool is_parallel) {
  const double slope = ranks.lower.slope;
  const auto split = [&](double across, int boundary) {
    const double share = static_cast<double>(boundary) / ranks.count;
    return (1 - share) * ranks.lower.At(across) + share * ranks.upper.At(across);
  };
  std::array<double, 2> low = {split(left.across, rank), split(right.across, rank)};
  std::array<double, 2> high = {split(left.across, rank + 1), split(right.across, rank + 1)};
  const bool is_slanted = std::abs(slope) > kSquareSlope;
  if (is_slanted) {
    low.fill(std::max(low[0], low[1]));
    high.fill(std::min(high[0], high[1]));
  }
  PlanarSlot slot;
  slot.corners = {row.Place(low[1], right.AcrossAt(low[1])), row.Place(high[1], right.AcrossAt(high[1])),
                  row.Place(high[0], left.AcrossAt(high[0])), row.Place(low[0], left.AcrossAt(low[0]))};
  if (SignedArea(slot.corners) < 0) std::reverse(slot.corners.begin(), slot.corners.end());
  slot.height = row.height;
  slot.kind = is_parallel ? SlotKind::kParallel : is_slanted ? SlotKind::kAngled : SlotKind::kPerpendicular;
  slot.angle = is_parallel ? 0 : 0.5 * std::numbers::pi - (is_slanted ? std::atan(std::abs(slope)) : 0);
  const double length = high[0] - low[0];
  const double left_share = left.Support(low[0], high[0]) / length;
  const double right_share = right.Support(low[1], high[1]) / length;
  slot.num_marked_sides = (left_share > kMarkedShare) + (right_share > kMarkedShare);
  slot.confidence = ConfidenceOf(left_share, right_share, ranks, row.dividers.size());
  return slot;
}

/// Slots beside a line that is not there are none, unless few of the row's lines are missing.
void AddSlots(const SlotRow& row, const Ranks& ranks, bool is_parallel, const SlotRowOptions& options,
              const IsBareGround& is_bare, std::vector<PlanarSlot>& slots) {
  const bool has_bare = HasBareLines(row, ranks, is_bare);
  const auto is_bare_in = [&](const RowDivider& divider, int rank) {
    const double low = ranks.lower.At(divider.across), length = (ranks.upper.At(divider.across) - low) / ranks.count;
    return SeeLine(row, divider, low + rank * length, low + (rank + 1) * length, is_bare).IsBare();
  };
  for (std::size_t i = 0; i + 1 < row.dividers.size(); ++i)
    for (int rank = 0; rank < ranks.count; ++rank) {
      if (has_bare && (is_bare_in(row.dividers[i], rank) || is_bare_in(row.dividers[i + 1], rank))) continue;
      const PlanarSlot slot = MakeSlot(row, ranks, rank, row.dividers[i], row.dividers[i + 1], is_parallel);
      if (slot.confidence >= options.min_confidence) slots.push_back(slot);
    }
}

/// A row whose ends many of its lines agree on, and all of them or two whole ones: nothing but paint looks like that.
bool IsBeyondDoubt(const SlotRow& row, const Ranks& ranks) {
  const int num_agreeing = std::max(ranks.lower.num_seen, ranks.upper.num_seen);
  return num_agreeing >= kFewLines && (num_agreeing == CountSeenLines(row) || HasWholeLines(row, ranks));
}

/// What rows are looked for.
struct RowKind {
  const SlotMeasures& measures;
  bool is_parallel = false;
  bool is_doubtful = false;  ///< the lines may be something else than paint: only rows beyond doubt are taken
};

/// Rows of one kind; their lines are marked as used.
std::vector<SlotRow> FindRowsOf(const std::vector<PaintLine>& lines, const RowKind& kind, const SlotRowOptions& options,
                                std::vector<bool>& is_used) {
  const auto& [measures, is_parallel, is_doubtful] = kind;
  std::vector<std::size_t> seeds;
  const double min_seed = 0.5 * measures.min_length;
  const double max_seed = is_parallel ? 1.1 * measures.max_length : measures.LongestLine();
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (!lines[i].is_one_sided && lines[i].Length() >= min_seed && lines[i].Length() <= max_seed) seeds.push_back(i);
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](std::size_t a, std::size_t b) { return lines[a].Length() > lines[b].Length(); });
  std::vector<SlotRow> rows;
  for (const std::size_t seed : seeds) {
    if (is_used[seed]) continue;
    std::optional<SlotRow> row = GrowRow(lines, seed, measures, options, is_used);
    if (!row || (is_parallel && row->dividers.size() < 3)) continue;
    const std::optional<Ranks> ranks = FindRanks(*row, measures, is_parallel, measures.usual_length);
    if (!ranks || (is_doubtful && !IsBeyondDoubt(*row, *ranks))) continue;
    for (const std::size_t line : row->members) is_used[line] = true;
    rows.push_back(std::move(*row));
  }
  return rows;
}

/// The median of the lengths of slots in rows that tell it.
double FindUsualLength(const std::vector<SlotRow>& rows, const SlotMeasures& measures, bool is_parallel) {
  std::vector<double> lengths;
  for (const SlotRow& row : rows)
    if (const std::optional<Ranks> ranks = FindRanks(row, measures, is_parallel, measures.usual_length))
      if (ranks->is_length_measured)
        lengths.push_back(LengthBetween(ranks->lower, ranks->upper, row.pitch) / ranks->count);
  if (lengths.empty()) return measures.usual_length;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// Adds the slots of one kind of rows; returns how long they are along their lines [m].
double FindSlotsOf(const std::vector<PaintLine>& lines, const RowKind& kind, const SlotRowOptions& options,
                   const IsBareGround& is_bare, std::vector<bool>& is_used, std::vector<PlanarSlot>& slots) {
  const std::vector<SlotRow> rows = FindRowsOf(lines, kind, options, is_used);
  const double usual_length = FindUsualLength(rows, kind.measures, kind.is_parallel);
  for (const SlotRow& row : rows)
    if (const std::optional<Ranks> ranks = FindRanks(row, kind.measures, kind.is_parallel, usual_length))
      AddSlots(row, *ranks, kind.is_parallel, options, is_bare, slots);
  return usual_length;
}

/// The surest first; those that lie on one of them are left out. Back in the order of their rows.
std::vector<PlanarSlot> DropOverlaps(const std::vector<PlanarSlot>& slots) {
  std::vector<std::size_t> order(slots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return slots[a].confidence > slots[b].confidence; });
  std::vector<bool> is_kept(slots.size());
  for (const std::size_t i : order) {
    const double area = std::abs(SignedArea(slots[i].corners));
    bool is_free = true;
    for (std::size_t k = 0; k < slots.size() && is_free; ++k)
      is_free = !is_kept[k] || std::abs(slots[i].height - slots[k].height) > kMaxHeightStep ||
                SharedArea(slots[i].corners, slots[k].corners) <= kMaxShare * area;
    is_kept[i] = is_free;
  }
  std::vector<PlanarSlot> kept;
  for (std::size_t i = 0; i < slots.size(); ++i)
    if (is_kept[i]) kept.push_back(slots[i]);
  return kept;
}

}  // namespace

void SlotMeasures::Validate() const {
  Require(min_pitch > 0 && max_pitch > min_pitch, ErrorCode::kUsage, "slots: 0 < min_pitch < max_pitch");
  Require(min_length > 0 && max_length > min_length, ErrorCode::kUsage, "slots: 0 < min_length < max_length");
  Require(usual_length >= min_length && usual_length <= max_length, ErrorCode::kUsage,
          "slots: usual_length must be in min_length..max_length");
}

void SlotRowOptions::Validate() const {
  beside.Validate();
  behind.Validate();
  Require(max_missing >= 0, ErrorCode::kUsage, "slots: max_missing must not be negative");
  Require(min_confidence >= 0 && min_confidence <= 1, ErrorCode::kUsage, "slots: min_confidence must be in 0..1");
}

std::vector<PlanarSlot> FindSlotRows(const std::vector<PaintLine>& lines, const SlotRowOptions& options,
                                     const IsBareGround& is_bare) {
  options.Validate();
  std::vector<PlanarSlot> slots;
  std::vector<bool> is_used(lines.size());
  SlotMeasures beside = options.beside;
  beside.usual_length = FindSlotsOf(lines, {.measures = options.beside}, options, is_bare, is_used, slots);
  std::vector<bool> is_used_behind = is_used;
  for (std::size_t i = 0; i < lines.size(); ++i)
    is_used_behind[i] = is_used[i] || lines[i].Length() > options.behind.max_length;
  FindSlotsOf(lines, {.measures = options.behind, .is_parallel = true}, options, is_bare, is_used_behind, slots);
  // Where parked cars, or what is taken for them, reach up to every line, none has two sides.
  std::vector<PaintLine> edges = lines;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    is_used[i] = is_used[i] || edges[i].width > kMaxEdgeWidth || edges[i].contrast < kMinEdgeContrast;
    edges[i].is_one_sided = false;
  }
  FindSlotsOf(edges, {.measures = beside, .is_doubtful = true}, options, is_bare, is_used, slots);
  return DropOverlaps(slots);
}

}  // namespace parkade
