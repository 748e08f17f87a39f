#include "mapping/markings/slot_row_growth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr double kRowReach = 60;         // [m] across from the line a row starts from
constexpr double kPitchReach = 15;       // [m] the same for lines that say what its pitch is
constexpr double kMaxHeightStep = 1.2;   // [m] between lines of one deck
constexpr double kTurn_deg = 3.5;        // between long lines of one row
constexpr double kShortTurn_deg = 7;     // the same for short ones
constexpr double kLongLine = 1.5;        // [m]
constexpr double kMinOverlap = 0.4;      // [m] along, of neighbors
constexpr double kSameDivider = 0.16;    // [m] across, of stretches of one line
constexpr double kPitchTolerance = 0.2;  // [m] from line to line
constexpr double kEdgeTolerance = 0.12;  // [m] the same for what may be the edge of something
constexpr double kMaxSlide =
    0.6;  // [m] along per [m] across, by which the ends of slanted rows move on
constexpr double kMaxHidden = 3.0;  // [m] that a car may hide of a line; aisles are wider

struct Candidate {
  std::size_t line = 0;
  PaintStretch stretch;
  bool is_edge = false;  ///< PaintLine::is_one_sided
};

double Overlap(const PaintStretch& a, const PaintStretch& b) {
  return std::min(a.end, b.end) - std::max(a.begin, b.begin);
}

PaintStretch StretchOf(const PaintLine& line, const SlotRow& row) {
  Vector2d begin = line.begin - row.origin, end = line.end - row.origin;
  bool is_begin_seen = line.is_begin_seen, is_end_seen = line.is_end_seen;
  if (begin.dot(row.along) > end.dot(row.along))
    std::swap(begin, end), std::swap(is_begin_seen, is_end_seen);
  return {begin.dot(row.along),
          end.dot(row.along),
          begin.dot(row.across),
          end.dot(row.across),
          is_begin_seen,
          is_end_seen,
          line.width};
}

/// Lines parallel to the seed on its deck, by place across.
std::vector<Candidate> FindParallels(const std::vector<PaintLine>& lines, const PaintLine& seed,
                                     const SlotRow& row, const SlotMeasures& measures,
                                     const std::vector<bool>& is_used) {
  std::vector<Candidate> parallels;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const PaintLine& line = lines[i];
    if (is_used[i] || std::abs(line.height - seed.height) > kMaxHeightStep) continue;
    if (line.Length() > measures.LongestLine()) continue;
    const double turn = std::acos(std::min(1.0, std::abs(line.Direction().dot(row.along)))) * 180 /
                        std::numbers::pi;
    if (turn > (line.Length() > kLongLine ? kTurn_deg : kShortTurn_deg)) continue;
    const PaintStretch stretch = StretchOf(line, row);
    if (std::abs(stretch.Across()) < kRowReach)
      parallels.push_back({i, stretch, line.is_one_sided});
  }
  std::stable_sort(parallels.begin(), parallels.end(), [](const Candidate& a, const Candidate& b) {
    return a.stretch.Across() < b.stretch.Across();
  });
  return parallels;
}

/// [m] the distance across that most neighbors of the row's surroundings have; nothing where there
/// are none.
std::optional<double> FindPitch(const std::vector<Candidate>& parallels, const PaintStretch& seed,
                                const SlotMeasures& measures) {
  constexpr double kBin = 0.05;
  const int num_bins = static_cast<int>((measures.max_pitch - measures.min_pitch) / kBin) + 2;
  std::vector<double> votes(static_cast<std::size_t>(num_bins)), sums(votes.size());
  for (std::size_t i = 0; i < parallels.size(); ++i)
    for (std::size_t k = i + 1; k < parallels.size(); ++k) {
      const PaintStretch &a = parallels[i].stretch, &b = parallels[k].stretch;
      const double distance = b.Across() - a.Across(), overlap = Overlap(a, b);
      if (distance > measures.max_pitch) break;
      if (parallels[i].is_edge || parallels[k].is_edge) continue;
      const bool is_far =
          std::abs(a.Across()) > kPitchReach || std::min(Overlap(a, seed), Overlap(b, seed)) < 0;
      if (distance < measures.min_pitch || overlap < kMinOverlap || is_far) continue;
      const auto bin = static_cast<std::size_t>((distance - measures.min_pitch) / kBin);
      votes[bin] += overlap;
      sums[bin] += overlap * distance;
    }
  std::size_t best = 0;
  double best_votes = 0;
  for (std::size_t i = 0; i + 1 < votes.size(); ++i)
    if (votes[i] + votes[i + 1] > best_votes) best = i, best_votes = votes[i] + votes[i + 1];
  if (!(best_votes > 0)) return {};
  return (sums[best] + sums[best + 1]) / best_votes;
}

/// Whether a stretch lies beside what is known of a divider, moved along by up to `slide` [m].
bool IsBeside(const PaintStretch& stretch, const RowDivider& divider, double slide) {
  return std::any_of(
      divider.stretches.begin(), divider.stretches.end(),
      [&](const PaintStretch& other) { return Overlap(stretch, other) > kMinOverlap - slide; });
}

/// Where a row's next divider is looked for.
struct NextDivider {
  double across = 0, tolerance = 0;  ///< [m]
  double slide = 0;                  ///< [m] along
  bool is_edge = false;              ///< made of what may be the edge of something
};

/// The divider whose paint lies where it is looked for: of all places the one with the most paint.
std::optional<RowDivider> FindDivider(const std::vector<Candidate>& parallels,
                                      const RowDivider& from, const NextDivider& next,
                                      std::vector<std::size_t>& members) {
  RowDivider best;
  std::vector<std::size_t> best_members;
  double best_support = 0;
  for (const Candidate& middle : parallels) {
    if (std::abs(middle.stretch.Across() - next.across) > next.tolerance ||
        middle.is_edge != next.is_edge || !IsBeside(middle.stretch, from, next.slide))
      continue;
    RowDivider divider;
    std::vector<std::size_t> of_divider;
    double support = 0, sum = 0;
    for (const Candidate& other : parallels) {
      if (std::abs(other.stretch.Across() - middle.stretch.Across()) > kSameDivider ||
          !IsBeside(other.stretch, from, next.slide))
        continue;
      divider.stretches.push_back(other.stretch);
      of_divider.push_back(other.line);
      support += other.stretch.Length();
      sum += other.stretch.Length() * other.stretch.Across();
    }
    divider.across = sum / support;
    if (support > best_support) best_support = support, best = divider, best_members = of_divider;
  }
  if (!(best_support > 0)) return {};
  members.insert(members.end(), best_members.begin(), best_members.end());
  return best;
}

/// Adds dividers to one side of the row until none follows. Of slanted rows little more than the
/// ends may be seen, which do not lie beside each other: they come last.
void Grow(const std::vector<Candidate>& parallels, const SlotRowOptions& options, double sign,
          SlotRow& row) {
  double pitch = row.pitch;
  while (true) {
    const RowDivider from = sign > 0 ? row.dividers.back() : row.dividers.front();
    std::optional<RowDivider> found;
    int steps = 1;
    for (; steps <= 1 + options.max_missing && !found; ++steps) {
      const double expected = from.across + sign * steps * pitch, slack = 0.05 * (steps - 1);
      for (const NextDivider& next :
           {NextDivider{expected, kPitchTolerance + slack, 0, false},
            NextDivider{expected, kEdgeTolerance + slack, 0, true},
            NextDivider{expected, kEdgeTolerance + slack, kMaxSlide * row.pitch, false}})
        if (!found) found = FindDivider(parallels, from, next, row.members);
    }
    if (!found) return;
    --steps;
    const double step = (found->across - from.across) / steps;
    for (int i = 1; i < steps; ++i) {
      const RowDivider hidden{from.across + i * step};
      row.dividers.insert(sign > 0 ? row.dividers.end() : row.dividers.begin(), hidden);
    }
    row.dividers.insert(sign > 0 ? row.dividers.end() : row.dividers.begin(), *found);
    pitch += 0.3 * (std::abs(step) - pitch);
    if (std::abs(found->across) > kRowReach) return;
  }
}

}  // namespace

std::optional<SlotRow> GrowRow(const std::vector<PaintLine>& lines, std::size_t seed,
                               const SlotMeasures& measures, const SlotRowOptions& options,
                               const std::vector<bool>& is_used) {
  SlotRow row;
  row.origin = lines[seed].Middle();
  row.along = lines[seed].Direction();
  row.across = {-row.along.y(), row.along.x()};
  row.height = lines[seed].height;
  const std::vector<Candidate> parallels =
      FindParallels(lines, lines[seed], row, measures, is_used);
  const PaintStretch own = StretchOf(lines[seed], row);
  const std::optional<double> pitch = FindPitch(parallels, own, measures);
  if (!pitch) return {};
  row.pitch = *pitch;
  RowDivider first;
  for (const Candidate& candidate : parallels)
    if (std::abs(candidate.stretch.Across()) < kSameDivider && !candidate.is_edge) {
      const double gap = -Overlap(candidate.stretch, own);
      if (gap > kMaxHidden) continue;
      first.stretches.push_back(candidate.stretch);
      row.members.push_back(candidate.line);
    }
  row.dividers.push_back(first);
  Grow(parallels, options, 1, row);
  Grow(parallels, options, -1, row);
  if (row.dividers.size() < 2) return {};
  return row;
}

}  // namespace parkade
