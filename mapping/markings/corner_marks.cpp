#include "mapping/markings/corner_marks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/math/statistics.h"
#include "mapping/ground/quadrilateral.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr double kLongest = 1.8;    // [m] of a stem or a bar
constexpr double kShortest = 0.45;  // [m] of a stem, from the middle of its bar
constexpr double kTouch = 0.25;     // [m] between a stem's end, or its bar's, and where both meet
constexpr double kSquare_deg = 8;   // by which their angle may differ from a right one
constexpr double kAlike_deg = 8;    // between stems of a row
constexpr double kInLine = 0.3;     // [m] between a row's line and its marks ...
constexpr double kBend = 0.015;     // ... and of the distance along it
constexpr double kMaxHeightStep = 1.2;  // [m] between lines of one deck
constexpr double kSame = 0.35;          // [m] between marks of one corner, as neighbors paint it
constexpr double kTolerance = 0.1;      // of the pitch, of a distance between marks
constexpr std::size_t kMinMarks = 3;    // of a row
constexpr double kSureRow = 0.85, kRow = 0.7;  // confidence of slots between neighbors in rows of
constexpr std::size_t kSureMarks = 5;          // so many marks or fewer,
constexpr double kPerHidden = 0.25;            // and what each mark that is not seen takes

/// A corner, or two neighbors' common one.
struct Mark {
  Vector2d corner, into;  ///< [m] in site; unit, from the entrance into the slot
  double height = 0;      ///< [m] in site
};

/// The mark of two lines, one of which is the stem.
std::optional<Mark> MarkOf(const PaintLine& stem, const PaintLine& bar) {
  if (std::abs(stem.height - bar.height) > kMaxHeightStep ||
      (stem.Middle() - bar.Middle()).norm() > kLongest)
    return {};
  const Vector2d along = stem.Direction(), across = bar.Direction();
  if (std::abs(along.dot(across)) > std::sin(kSquare_deg * std::numbers::pi / 180)) return {};
  const double determinant = along.x() * across.y() - along.y() * across.x();
  const Vector2d between = bar.begin - stem.begin;
  const double on_stem = (between.x() * across.y() - between.y() * across.x()) / determinant,
               on_bar = (between.x() * along.y() - between.y() * along.x()) / determinant;
  if (on_bar < -kTouch || on_bar > bar.Length() + kTouch) return {};
  const double length = stem.Length();
  const bool is_at_begin = std::abs(on_stem) <= kTouch,
             is_at_end = std::abs(on_stem - length) <= kTouch;
  if (is_at_begin == is_at_end) return {};
  if ((is_at_begin ? length - on_stem : on_stem) < kShortest) return {};
  return Mark{stem.begin + on_stem * along, is_at_begin ? along : Vector2d(-along), stem.height};
}

std::vector<Mark> FindMarks(const std::vector<PaintLine>& lines, const std::vector<bool>& is_used) {
  std::vector<const PaintLine*> strokes;
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (!is_used[i] && lines[i].Length() <= kLongest) strokes.push_back(&lines[i]);
  std::vector<Mark> marks;
  for (const PaintLine* stem : strokes)
    for (const PaintLine* bar : strokes)
      if (const std::optional<Mark> mark = stem == bar ? std::nullopt : MarkOf(*stem, *bar)) {
        const bool is_known = std::any_of(marks.begin(), marks.end(), [&](const Mark& other) {
          return (other.corner - mark->corner).norm() < kSame && other.into.dot(mark->into) > 0.9;
        });
        if (!is_known) marks.push_back(*mark);
      }
  return marks;
}

/// Marks in line with one of them, by how far along it they lie.
struct Rank {
  Vector2d along;
  std::vector<double> places;  ///< [m] from the one, ascending
  std::vector<const Mark*> marks;
};

Rank RankOf(const std::vector<Mark>& marks, const Mark& seed) {
  std::vector<std::pair<double, const Mark*>> in_line;
  Rank rank{{seed.into.y(), -seed.into.x()}, {}, {}};
  for (const Mark& mark : marks) {
    const Vector2d offset = mark.corner - seed.corner;
    const double place = offset.dot(rank.along);
    if (mark.into.dot(seed.into) > std::cos(kAlike_deg * std::numbers::pi / 180) &&
        std::abs(offset.dot(seed.into)) < kInLine + kBend * std::abs(place) &&
        std::abs(mark.height - seed.height) < kMaxHeightStep)
      in_line.emplace_back(place, &mark);
  }
  std::sort(in_line.begin(), in_line.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [place, mark] : in_line)
    if (rank.places.empty() || place - rank.places.back() > kSame) {
      rank.places.push_back(place);
      rank.marks.push_back(mark);
    }
  return rank;
}

/// [m] between neighbors, as most of them have it.
std::optional<double> PitchOf(const Rank& rank, const SlotMeasures& measures) {
  std::vector<double> distances;
  for (std::size_t i = 1; i < rank.places.size(); ++i)
    if (const double distance = rank.places[i] - rank.places[i - 1];
        distance >= measures.min_pitch && distance <= measures.max_pitch)
      distances.push_back(distance);
  if (distances.empty()) return {};
  return Median(std::move(distances));
}

/// How many slots lie between two places; 0 where the pitch does not fit.
int SlotsBetween(double distance, double pitch, int max_missing) {
  const int count = static_cast<int>(std::lround(distance / pitch));
  const bool fits = count >= 1 && count <= 1 + max_missing &&
                    std::abs(distance - count * pitch) < kTolerance * pitch * std::sqrt(count);
  return fits ? count : 0;
}

PlanarSlot SlotBetween(const Mark& left, const Mark& right, double begin, double end,
                       double depth) {
  const Vector2d way = right.corner - left.corner;
  Vector2d into(-way.y(), way.x());
  into *= (into.dot(left.into) > 0 ? depth : -depth) / into.norm();
  PlanarSlot slot;
  const Vector2d first = left.corner + begin * way, second = left.corner + end * way;
  slot.corners = {first, second, second + into, first + into};
  if (SignedArea(slot.corners) < 0) std::reverse(slot.corners.begin(), slot.corners.end());
  slot.height = 0.5 * (left.height + right.height);
  return slot;
}

/// Adds the slots of the row that a mark is in; returns its marks, none where it is in no row.
std::vector<const Mark*> AddRow(const std::vector<Mark>& marks, const Mark& seed, double depth,
                                bool is_parallel, const SlotRowOptions& options,
                                std::vector<PlanarSlot>& slots) {
  const SlotMeasures& measures = is_parallel ? options.behind : options.beside;
  const Rank rank = RankOf(marks, seed);
  const std::optional<double> pitch = PitchOf(rank, measures);
  if (!pitch) return {};
  const auto follows = [&](std::size_t i) {
    return SlotsBetween(rank.places[i] - rank.places[i - 1], *pitch, options.max_missing);
  };
  std::size_t first = static_cast<std::size_t>(
      std::find(rank.marks.begin(), rank.marks.end(), &seed) - rank.marks.begin());
  if (first == rank.marks.size()) return {};
  std::size_t last = first;
  while (first > 0 && follows(first) > 0) --first;
  while (last + 1 < rank.marks.size() && follows(last + 1) > 0) ++last;
  const std::size_t count = last - first + 1;
  if (count < kMinMarks) return {};
  for (std::size_t i = first + 1; i <= last; ++i) {
    const int between = follows(i);
    for (int k = 0; k < between; ++k) {
      PlanarSlot slot =
          SlotBetween(*rank.marks[i - 1], *rank.marks[i], static_cast<double>(k) / between,
                      static_cast<double>(k + 1) / between, depth);
      slot.kind = is_parallel ? SlotKind::kParallel : SlotKind::kPerpendicular;
      slot.angle = is_parallel ? 0 : 0.5 * std::numbers::pi;
      slot.num_marked_sides = (k == 0) + (k + 1 == between);
      slot.confidence =
          (count >= kSureMarks ? kSureRow : kRow) - kPerHidden * (2 - slot.num_marked_sides);
      if (slot.num_marked_sides > 0 && slot.confidence >= options.min_confidence)
        slots.push_back(slot);
    }
  }
  return {rank.marks.begin() + static_cast<std::ptrdiff_t>(first),
          rank.marks.begin() + static_cast<std::ptrdiff_t>(last) + 1};
}

}  // namespace

std::vector<PlanarSlot> FindSlotsAtMarks(const std::vector<PaintLine>& lines,
                                         const std::vector<bool>& is_used, double usual_length,
                                         const SlotRowOptions& options) {
  const std::vector<Mark> marks = FindMarks(lines, is_used);
  std::vector<PlanarSlot> slots;
  for (const bool is_parallel : {false, true}) {
    std::vector<const Mark*> done;
    for (const Mark& mark : marks) {
      if (std::find(done.begin(), done.end(), &mark) != done.end()) continue;
      const double depth = is_parallel ? options.behind.usual_length : usual_length;
      const std::vector<const Mark*> row = AddRow(marks, mark, depth, is_parallel, options, slots);
      done.insert(done.end(), row.begin(), row.end());
    }
  }
  return slots;
}

}  // namespace parkade
