#include "mapping/markings/corner_marks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "mapping/ground/quadrilateral.h"
#include "mapping/ground/square_index.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr double kLongest = 1.8;    // [m] of a stem; bars of neighbors may join
constexpr double kShortest = 0.45;  // [m] of a stem, from the middle of its bar
constexpr double kTouch = 0.25;     // [m] between a stem's end, or its bar's, and where both meet
constexpr double kSquareTurn = 8;   // [deg] by which their angle may differ from a right one
constexpr double kAlikeTurn = 8;    // [deg] between stems of a row
constexpr double kInLine = 0.3;     // [m] between a row's line and its marks ...
constexpr double kBend = 0.015;     // ... and of the distance along it
constexpr double kMaxHeightStep = 1.2;  // [m] between lines of one deck
constexpr double kSame = 0.35;          // [m] between marks of one corner, as neighbors paint it
constexpr double kApart = 0.8;          // [m] between slots side by side
constexpr double kTolerance = 0.1;      // of the pitch, of a distance between marks
constexpr std::size_t kMinMarks = 3;    // of a row
constexpr double kSureRow = 0.85, kRow = 0.7;  // confidence of slots between neighbors in rows of
constexpr std::size_t kSureMarks = 5;          // so many marks or fewer,
constexpr double kPerHidden = 0.25;            // and what each mark that is not seen takes

/// A corner, or two neighbors' common one.
struct Mark {
  Vector2d corner, into;  ///< [m] in site; unit, from the entrance into the slot
  double height = 0;      ///< [m] in site
  std::size_t stem = 0, bar = 0;
};

/// The mark of two lines, one of which is the stem.
std::optional<Mark> MarkOf(const PaintLine& stem, const PaintLine& bar) {
  if (std::abs(stem.height - bar.height) > kMaxHeightStep) return {};
  const Vector2d along = stem.Direction(), across = bar.Direction();
  if (std::abs(along.dot(across)) > std::sin(kSquareTurn * std::numbers::pi / 180)) return {};
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
  return Mark{.corner = stem.begin + on_stem * along,
              .into = is_at_begin ? along : Vector2d(-along),
              .height = stem.height};
}

/// Marks of what is paint for sure: the edges of cars and shadows meet at right angles, too.
std::vector<Mark> FindMarks(const std::vector<PaintLine>& lines, const std::vector<bool>& is_used) {
  constexpr double kStep = 1;  // [m] along lines
  const auto is_paint = [&](std::size_t i) { return !is_used[i] && !lines[i].is_one_sided; };
  SquareIndex<std::size_t> nearby(kStep);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!is_paint(i)) continue;
    const int steps = static_cast<int>(lines[i].Length() / kStep) + 1;
    for (int k = 0; k <= steps; ++k)
      nearby.Add(lines[i].begin + static_cast<double>(k) / steps * (lines[i].end - lines[i].begin),
                 i);
  }
  std::vector<Mark> marks;
  SquareIndex<Mark> known(kSame);
  const auto add = [&](const Mark& mark) {
    bool is_known = false;
    known.VisitAround(mark.corner, kSame, [&](const Mark& other) {
      is_known = is_known ||
                 ((other.corner - mark.corner).norm() < kSame && other.into.dot(mark.into) > 0.9);
    });
    if (is_known) return;
    known.Add(mark.corner, mark);
    marks.push_back(mark);
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!is_paint(i) || lines[i].Length() > kLongest) continue;
    for (const Vector2d& end : {lines[i].begin, lines[i].end}) {
      std::set<std::size_t> bars;
      nearby.VisitAround(end, kStep, [&](std::size_t k) { bars.insert(k); });
      for (const std::size_t k : bars)
        if (std::optional<Mark> mark = i == k ? std::nullopt : MarkOf(lines[i], lines[k])) {
          mark->stem = i, mark->bar = k;
          add(*mark);
        }
    }
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
    if (mark.into.dot(seed.into) > std::cos(kAlikeTurn * std::numbers::pi / 180) &&
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

/// [m] between neighbors, as most marks of a rank have it.
std::optional<double> PitchOf(const Rank& rank, const SlotMeasures& measures) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < rank.places.size(); ++i)
    for (std::size_t k = i + 1; k < rank.places.size(); ++k)
      if (const double distance = rank.places[k] - rank.places[i]; distance > measures.max_pitch)
        break;
      else if (distance >= measures.min_pitch)
        distances.push_back(distance);
  std::sort(distances.begin(), distances.end());
  double best = 0;
  std::ptrdiff_t most = 0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const auto end =
        std::upper_bound(distances.begin(), distances.end(), distances[i] * (1 + kTolerance));
    const std::ptrdiff_t count = end - distances.begin() - static_cast<std::ptrdiff_t>(i);
    if (count <= most) continue;
    most = count;
    best = distances[i + static_cast<std::size_t>(count) / 2];
  }
  if (most == 0) return {};
  return best;
}

/// How many slots lie between two places; 0 where the pitch does not fit.
int SlotsBetween(double distance, double pitch, int max_missing) {
  const int count = static_cast<int>(std::lround(distance / pitch));
  const bool fits = count >= 1 && count <= 1 + max_missing &&
                    std::abs(distance - count * pitch) < kTolerance * pitch * std::sqrt(count);
  return fits ? count : 0;
}

/// The mark that follows one in a row, and how many slots lie between the two.
struct Next {
  std::size_t mark = 0;
  int slots = 0;  ///< 0: none follows
};

/// The nearest that the pitch fits. Between may be one mark for each slot, of slots that stand
/// apart, but no others.
Next NextOf(const Rank& rank, std::size_t mark, double pitch, int max_missing, bool is_forward) {
  const auto count = rank.places.size();
  int num_between = 0;
  for (std::size_t i = mark; is_forward ? ++i < count : i-- > 0; ++num_between) {
    const double distance = std::abs(rank.places[i] - rank.places[mark]);
    if (const int slots = SlotsBetween(distance, pitch, max_missing))
      return num_between <= slots ? Next{i, slots} : Next{};
    if (std::abs(distance - std::round(distance / pitch) * pitch) > kApart) return {};
  }
  return {};
}

/// Whether bare ground is seen where several marks side by side would be; a single one wears off.
bool IsDriveway(const Mark& left, const Mark& right, int num_slots, const IsBareGround& is_bare) {
  if (!is_bare || num_slots < 3) return false;
  for (int i = 1; i < num_slots; ++i) {
    const Vector2d corner =
        left.corner + static_cast<double>(i) / num_slots * (right.corner - left.corner);
    for (const double along : {0.0, 0.5 * kShortest, kShortest})
      if (!is_bare(corner + along * left.into, left.height)) return false;
  }
  return true;
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
                                const IsBareGround& is_bare, std::vector<PlanarSlot>& slots) {
  const SlotMeasures& measures = is_parallel ? options.behind : options.beside;
  const Rank rank = RankOf(marks, seed);
  const std::optional<double> pitch = PitchOf(rank, measures);
  if (!pitch) return {};
  const auto found = std::find(rank.marks.begin(), rank.marks.end(), &seed);
  if (found == rank.marks.end()) return {};
  auto first = static_cast<std::size_t>(found - rank.marks.begin());
  for (Next next; (next = NextOf(rank, first, *pitch, options.max_missing, false)).slots > 0;)
    first = next.mark;
  std::vector<const Mark*> row = {rank.marks[first]};
  std::vector<int> between;
  for (Next next{first, 0};
       (next = NextOf(rank, next.mark, *pitch, options.max_missing, true)).slots > 0;) {
    row.push_back(rank.marks[next.mark]);
    between.push_back(next.slots);
  }
  if (row.size() < kMinMarks) return {};
  for (std::size_t i = 0; i < between.size(); ++i) {
    if (IsDriveway(*row[i], *row[i + 1], between[i], is_bare)) continue;
    for (int k = 0; k < between[i]; ++k) {
      PlanarSlot slot = SlotBetween(*row[i], *row[i + 1], static_cast<double>(k) / between[i],
                                    static_cast<double>(k + 1) / between[i], depth);
      slot.kind = is_parallel ? SlotKind::kParallel : SlotKind::kPerpendicular;
      slot.angle = is_parallel ? 0 : 0.5 * std::numbers::pi;
      slot.num_marked_sides = (k == 0) + (k + 1 == between[i]);
      slot.confidence =
          (row.size() >= kSureMarks ? kSureRow : kRow) - kPerHidden * (2 - slot.num_marked_sides);
      if (slot.num_marked_sides > 0 && slot.confidence >= options.min_confidence)
        slots.push_back(slot);
    }
  }
  return row;
}

}  // namespace

std::vector<PlanarSlot> FindSlotsAtMarks(const std::vector<PaintLine>& lines,
                                         const std::vector<bool>& is_used, double usual_length,
                                         const SlotRowOptions& options,
                                         const IsBareGround& is_bare) {
  std::vector<Mark> marks = FindMarks(lines, is_used);
  std::vector<PlanarSlot> slots;
  std::vector<bool> is_spent(lines.size());  // stems of rows: those of angles are no bars of others
  for (const bool is_parallel : {false, true}) {
    const double depth = is_parallel ? options.behind.usual_length : usual_length;
    for (const Mark& mark : marks) {
      if (is_spent[mark.stem]) continue;
      for (const Mark* of_row : AddRow(marks, mark, depth, is_parallel, options, is_bare, slots))
        is_spent[of_row->stem] = true;
    }
    std::erase_if(marks,
                  [&](const Mark& mark) { return is_spent[mark.stem] || is_spent[mark.bar]; });
  }
  return slots;
}

}  // namespace parkade
