#include "mapping/markings/slot_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "mapping/ground/quadrilateral.h"
#include "mapping/markings/corner_marks.h"
#include "mapping/markings/row_layout.h"
#include "mapping/markings/slot_row_growth.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr double kMaxHeightStep = 1.2;  // [m] between lines of one deck
constexpr double kMaxEdgeWidth =
    0.2;  // [m] of what has an unseen side and may be paint all the same ...
constexpr double kMinEdgeContrast = 0.12;
constexpr double kMarkedShare = 0.12;   // of a side's length from which it counts as seen
constexpr double kBareStep = 0.2;       // [m] along lines that may be missing
constexpr double kWornShare = 1.0 / 3;  // of a row's paint that may have worn off
constexpr double kMaxShare = 0.25;      // of a slot that a surer one may cover

/// What is seen where a line should be.
struct SeenLine {
  double painted = 0, bare = 0;  ///< [m]

  bool IsBare() const { return bare > painted; }
};

/// What is seen of one line of a row between two places along it.
SeenLine SeeLine(const SlotRow& row, const RowDivider& divider, double from, double to,
                 const IsBareGround& is_bare) {
  SeenLine seen;
  const int num_steps = static_cast<int>(std::ceil((to - from) / kBareStep - 0.5));
  for (int i = 0; i < num_steps; ++i) {
    const double along = from + (i + 0.5) * kBareStep;
    if (divider.Support(along - kBareStep / 2, along + kBareStep / 2) > 0)
      seen.painted += kBareStep;
    else if (is_bare && is_bare(row.Place(along, divider.AcrossAt(along)), row.height))
      seen.bare += kBareStep;
  }
  return seen;
}

/// Whether so much bare ground is seen where a row's lines should be that single ones are not just
/// worn off.
bool HasBareLines(const SlotRow& row, const RowLayout& ranks, const IsBareGround& is_bare) {
  SeenLine sum;
  for (const RowDivider& divider : row.dividers) {
    const SeenLine seen = SeeLine(row, divider, ranks.lower.At(divider.across),
                                  ranks.upper.At(divider.across), is_bare);
    sum.painted += seen.painted, sum.bare += seen.bare;
  }
  return sum.bare > kWornShare * sum.painted;
}

double ConfidenceOf(double left_share, double right_share, const RowLayout& ranks,
                    std::size_t num_dividers) {
  const double ends = ranks.is_lower_known && ranks.is_upper_known ? 1 : 0.5;
  const double company = std::min(1.0, static_cast<double>(num_dividers) / 4);
  return std::min(1.0, 0.35 * std::min(1.0, 1.3 * left_share) +
                           0.35 * std::min(1.0, 1.3 * right_share) + 0.3 * ends * company);
}

/// The slot between two neighboring dividers, in one of the ranks.
PlanarSlot MakeSlot(const SlotRow& row, const RowLayout& ranks, int rank, const RowDivider& left,
                    const RowDivider& right, bool is_parallel) {
  const double slope = ranks.lower.slope;
  const auto split = [&](double across, int boundary) {
    const double share = static_cast<double>(boundary) / ranks.count;
    return (1 - share) * ranks.lower.At(across) + share * ranks.upper.At(across);
  };
  std::array<double, 2> low = {split(left.across, rank), split(right.across, rank)};
  std::array<double, 2> high = {split(left.across, rank + 1), split(right.across, rank + 1)};
  const bool is_slanted = ranks.IsSlanted();
  if (is_slanted) {
    low.fill(std::max(low[0], low[1]));
    high.fill(std::min(high[0], high[1]));
  }
  PlanarSlot slot;
  slot.corners = {
      row.Place(low[1], right.AcrossAt(low[1])), row.Place(high[1], right.AcrossAt(high[1])),
      row.Place(high[0], left.AcrossAt(high[0])), row.Place(low[0], left.AcrossAt(low[0]))};
  if (SignedArea(slot.corners) < 0) std::reverse(slot.corners.begin(), slot.corners.end());
  slot.height = row.height;
  slot.kind = is_parallel  ? SlotKind::kParallel
              : is_slanted ? SlotKind::kAngled
                           : SlotKind::kPerpendicular;
  slot.angle =
      is_parallel ? 0 : 0.5 * std::numbers::pi - (is_slanted ? std::atan(std::abs(slope)) : 0);
  const double length = high[0] - low[0];
  const double left_share = left.Support(low[0], high[0]) / length;
  const double right_share = right.Support(low[1], high[1]) / length;
  slot.num_marked_sides = (left_share > kMarkedShare) + (right_share > kMarkedShare);
  slot.confidence = ConfidenceOf(left_share, right_share, ranks, row.dividers.size());
  return slot;
}

/// Slots beside a line that is not there are none, unless few of the row's lines are missing.
void AddSlots(const SlotRow& row, const RowLayout& ranks, bool is_parallel,
              const SlotRowOptions& options, const IsBareGround& is_bare,
              std::vector<PlanarSlot>& slots) {
  const bool has_bare = HasBareLines(row, ranks, is_bare);
  const auto is_bare_in = [&](const RowDivider& divider, int rank) {
    const double low = ranks.lower.At(divider.across),
                 length = (ranks.upper.At(divider.across) - low) / ranks.count;
    return SeeLine(row, divider, low + rank * length, low + (rank + 1) * length, is_bare).IsBare();
  };
  for (std::size_t i = 0; i + 1 < row.dividers.size(); ++i)
    for (int rank = 0; rank < ranks.count; ++rank) {
      if (has_bare && (is_bare_in(row.dividers[i], rank) || is_bare_in(row.dividers[i + 1], rank)))
        continue;
      const PlanarSlot slot =
          MakeSlot(row, ranks, rank, row.dividers[i], row.dividers[i + 1], is_parallel);
      if (slot.confidence >= options.min_confidence) slots.push_back(slot);
    }
}

/// What rows are looked for.
struct RowKind {
  const SlotMeasures& measures;
  bool is_parallel = false;
  bool is_doubtful =
      false;  ///< the lines may be something else than paint: only rows beyond doubt are taken
};

/// Adds rows of one kind; their lines are marked as used.
void AddRowsOf(const std::vector<PaintLine>& lines, const RowKind& kind,
               const SlotRowOptions& options, const RowHabits& habits, std::vector<bool>& is_used,
               std::vector<SlotRow>& rows) {
  const auto& [measures, is_parallel, is_doubtful] = kind;
  std::vector<std::size_t> seeds;
  const double min_seed = 0.5 * measures.min_length;
  const double max_seed = is_parallel ? 1.1 * measures.max_length : measures.LongestLine();
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (!lines[i].is_one_sided && lines[i].Length() >= min_seed && lines[i].Length() <= max_seed)
      seeds.push_back(i);
  std::stable_sort(seeds.begin(), seeds.end(), [&](std::size_t a, std::size_t b) {
    return lines[a].Length() > lines[b].Length();
  });
  for (const std::size_t seed : seeds) {
    if (is_used[seed]) continue;
    std::optional<SlotRow> row = GrowRow(lines, seed, measures, options, is_used);
    if (!row || (is_parallel && row->dividers.size() < 3)) continue;
    const std::optional<RowLayout> ranks = FindRowLayout(*row, measures, is_parallel, habits);
    if (!ranks || (is_doubtful && !IsBeyondDoubt(*row, *ranks))) continue;
    for (const std::size_t line : row->members) is_used[line] = true;
    rows.push_back(std::move(*row));
  }
}

/// Adds the slots of one kind of rows; returns how long they are along their lines [m].
double FindSlotsOf(const std::vector<PaintLine>& lines, const RowKind& kind,
                   const SlotRowOptions& options, const IsBareGround& is_bare,
                   std::vector<bool>& is_used, std::vector<PlanarSlot>& slots) {
  std::vector<SlotRow> rows;
  RowHabits habits{kind.measures.usual_length, {}};
  AddRowsOf(lines, kind, options, habits, is_used, rows);
  habits = FindHabits(rows, kind.measures, kind.is_parallel);
  if (!habits.slants.empty()) AddRowsOf(lines, kind, options, habits, is_used, rows);
  for (const SlotRow& row : rows)
    if (const std::optional<RowLayout> ranks =
            FindRowLayout(row, kind.measures, kind.is_parallel, habits))
      AddSlots(row, *ranks, kind.is_parallel, options, is_bare, slots);
  return habits.length;
}

bool Excludes(const PlanarSlot& sure, const PlanarSlot& slot) {
  return std::abs(slot.height - sure.height) <= kMaxHeightStep &&
         SharedArea(slot.corners, sure.corners) > kMaxShare * std::abs(SignedArea(slot.corners));
}

/// Marks tell less than whole lines do: where these make slots they make none.
void AddSlotsAtMarks(const std::vector<PaintLine>& lines, const std::vector<bool>& is_spent,
                     double usual_length, const SlotRowOptions& options,
                     const IsBareGround& is_bare, std::vector<PlanarSlot>& slots) {
  std::vector<PlanarSlot> at_marks =
      FindSlotsAtMarks(lines, is_spent, usual_length, options, is_bare);
  std::erase_if(at_marks, [&](const PlanarSlot& slot) {
    return std::any_of(slots.begin(), slots.end(),
                       [&](const PlanarSlot& other) { return Excludes(other, slot); });
  });
  slots.insert(slots.end(), at_marks.begin(), at_marks.end());
}

/// The surest first; those that lie on one of them are left out. Back in the order of their rows.
std::vector<PlanarSlot> DropOverlaps(const std::vector<PlanarSlot>& slots) {
  std::vector<std::size_t> order(slots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return slots[a].confidence > slots[b].confidence;
  });
  std::vector<bool> is_kept(slots.size());
  for (const std::size_t i : order) {
    bool is_free = true;
    for (std::size_t k = 0; k < slots.size() && is_free; ++k)
      is_free = !is_kept[k] || !Excludes(slots[k], slots[i]);
    is_kept[i] = is_free;
  }
  std::vector<PlanarSlot> kept;
  for (std::size_t i = 0; i < slots.size(); ++i)
    if (is_kept[i]) kept.push_back(slots[i]);
  return kept;
}

}  // namespace

std::vector<PlanarSlot> FindSlotRows(const std::vector<PaintLine>& lines,
                                     const SlotRowOptions& options, const IsBareGround& is_bare) {
  options.Validate();
  std::vector<PlanarSlot> slots;
  std::vector<bool> is_used(lines.size());
  SlotMeasures beside = options.beside;
  beside.usual_length =
      FindSlotsOf(lines, {.measures = options.beside}, options, is_bare, is_used, slots);
  std::vector<bool> is_used_behind = is_used;
  for (std::size_t i = 0; i < lines.size(); ++i)
    is_used_behind[i] = is_used[i] || lines[i].Length() > options.behind.max_length;
  const std::vector<bool> was_used_behind = is_used_behind;
  FindSlotsOf(lines, {.measures = options.behind, .is_parallel = true}, options, is_bare,
              is_used_behind, slots);
  std::vector<bool> is_spent = is_used;  // also by parallel rows; long lines may still be bars
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (is_used_behind[i] != was_used_behind[i]) is_spent[i] = true;
  AddSlotsAtMarks(lines, is_spent, beside.usual_length, options, is_bare, slots);
  // Where parked cars, or what is taken for them, reach up to every line, none has two sides.
  std::vector<PaintLine> edges = lines;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    is_used[i] =
        is_used[i] || edges[i].width > kMaxEdgeWidth || edges[i].contrast < kMinEdgeContrast;
    edges[i].is_one_sided = false;
  }
  FindSlotsOf(edges, {.measures = beside, .is_doubtful = true}, options, is_bare, is_used, slots);
  return DropOverlaps(slots);
}

}  // namespace parkade
