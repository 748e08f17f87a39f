#include "mapping/markings/merge_slots.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "mapping/ground/quadrilateral.h"
#include "mapping/roadside/roadside_slots.h"

namespace parkade {
namespace {

constexpr double kSameSlot = 0.4;       // intersection over union
constexpr double kMaxShare = 0.25;      // of a slot that another one may cover
constexpr double kMaxHeightStep = 1.2;  // [m] between slots of one deck
constexpr double kMaxApart = 12;        // [m] between the middles of slots that overlap
constexpr double kAsBefore = 0.85;      // the same, of a slot in which cars stand as in another
constexpr double kSharedSide = 0.5;     // [m] between the middles of neighbors' common side
constexpr double kDoubt = 0.25;         // of a slot's confidence, that a bare line takes
constexpr double kAsSure = 0.2;         // of confidence: what differs by less is as sure
constexpr double kRounded = 0.01;  // of confidence, which files round: seen again it is the same

/// What the look says that drives saw in a slot.
KnownStates KnownOf(const SlotLook& look, const ParkingSlot& slot) {
  KnownStates known;
  for (std::size_t i = 0; i < std::min(slot.states.size(), look.tells_of.size()); ++i)
    known.push_back(look.tells_of[i] ? std::optional(slot.states[i]) : std::nullopt);
  return known;
}

/// A slot from above.
struct Outline {
  Quadrilateral corners;
  Eigen::Vector3d center;

  explicit Outline(const ParkingSlot& slot) : center(slot.Center()) {
    for (std::size_t i = 0; i < 4; ++i) corners[i] = slot.corners[i].head<2>();
  }

  bool IsNear(const Outline& other) const {
    return std::abs(center.z() - other.center.z()) < kMaxHeightStep &&
           (center - other.center).head<2>().squaredNorm() < kMaxApart * kMaxApart;
  }
  /// Whether one covers too much of the other for both to be slots.
  bool Excludes(const Outline& other) const {
    return IsNear(other) &&
           SharedArea(corners, other.corners) >
               kMaxShare * std::min(SignedArea(corners), SignedArea(other.corners));
  }
  Eigen::Vector2d Side(std::size_t index) const {  ///< the middle of one of two
    return 0.5 * (corners[2 * index + 1] + corners[(2 * index + 2) % 4]);
  }
  bool IsBeside(const Outline& other) const {
    for (const std::size_t a : {0U, 1U})
      for (const std::size_t b : {0U, 1U})
        if (IsNear(other) && (Side(a) - other.Side(b)).norm() < kSharedSide) return true;
    return false;
  }
};

/// Whether what was seen in a slot holds for another outline of it.
bool IsAsBefore(const Outline& outline, const Outline& before) {
  return outline.IsNear(before) && OverlapOf(outline.corners, before.corners) >= kAsBefore;
}

std::vector<Outline> OutlinesOf(const std::vector<SlotCandidate>& candidates) {
  std::vector<Outline> outlines;
  outlines.reserve(candidates.size());
  for (const SlotCandidate& candidate : candidates) outlines.emplace_back(candidate.slot);
  return outlines;
}

/// Lines of a slot that are not there, of those that ever were.
std::ptrdiff_t CountBare(const SlotCandidate& candidate) {
  if (!IsMarked(candidate.slot)) return 0;
  return std::count(candidate.sides.begin(), candidate.sides.end(), PaintSeen::kBare);
}

bool IsGone(const SlotCandidate& candidate) {
  if (CountBare(candidate) < 2) return false;
  const std::vector<SlotState>& states = candidate.slot.states;
  return std::any_of(states.begin() + candidate.last_drive + 1, states.end(),
                     [](SlotState state) { return state == SlotState::kFree; });
}

/// The row of each slot, as the index of one of its slots: slots beside each other are of one row.
std::vector<std::size_t> RowsOf(const std::vector<Outline>& outlines) {
  std::vector<std::size_t> rows(outlines.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (rows[i] != i) i = rows[i] = rows[rows[i]];
    return i;
  };
  for (std::size_t i = 0; i < outlines.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (outlines[i].IsBeside(outlines[k])) rows[find(i)] = find(k);
  for (std::size_t& row : rows) row = find(row);
  return rows;
}

/// Which slots give way to others that lie on them.
std::vector<bool> FindDoubtful(const std::vector<SlotCandidate>& candidates,
                               const std::vector<std::size_t>& rows) {
  std::vector<int> balance(candidates.size());  // by row: slots that stand, less those that do not
  const auto is_painted = [](const SlotCandidate& candidate) {
    return std::find(candidate.sides.begin(), candidate.sides.end(), PaintSeen::kPainted) !=
           candidate.sides.end();
  };
  for (std::size_t i = 0; i < candidates.size(); ++i)
    balance[rows[i]] += IsGone(candidates[i]) ? -1 : is_painted(candidates[i]) ? 1 : 0;
  std::vector<bool> is_doubtful;
  is_doubtful.reserve(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i)
    is_doubtful.push_back(CountBare(candidates[i]) > 0 ||
                          (balance[rows[i]] < 0 && !is_painted(candidates[i])));
  return is_doubtful;
}

}  // namespace

std::vector<SlotCandidate> MatchLooks(std::span<const SlotLook> looks) {
  std::vector<SlotCandidate> candidates;
  std::vector<bool> is_established;
  for (const SlotLook& look : looks) {
    const std::vector<Outline> before = OutlinesOf(candidates);
    std::vector<bool> is_matched(before.size());
    for (const ParkingSlot& slot : look.slots) {
      const Outline outline(slot);
      std::optional<std::size_t> best;
      double best_overlap = kSameSlot;
      for (std::size_t i = 0; i < before.size(); ++i) {
        if (is_matched[i] || !outline.IsNear(before[i])) continue;
        const double overlap = OverlapOf(outline.corners, before[i].corners);
        if (overlap >= best_overlap) best = i, best_overlap = overlap;
      }
      if (!best) {
        candidates.push_back({slot, look.drive, {}, KnownOf(look, slot)});
        is_established.push_back(look.establishes);
        continue;
      }
      is_matched[*best] = true;
      SlotCandidate& same = candidates[*best];
      const std::string id = same.slot.id.empty() ? slot.id : same.slot.id;
      const bool is_better =
          look.establishes &&
          (!is_established[*best] || slot.confidence >= same.slot.confidence - kRounded);
      if (is_better) {
        if (!IsAsBefore(outline, before[*best])) same.known.clear();
        same.slot = slot;
      }
      same.slot.id = id;
      if (look.establishes) same.last_drive = std::max(same.last_drive, look.drive);
      is_established[*best] = is_established[*best] || look.establishes;
    }
  }
  std::vector<SlotCandidate> established;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (is_established[i]) established.push_back(std::move(candidates[i]));
  return established;
}

std::vector<ParkingSlot> ChooseSlots(const std::vector<SlotCandidate>& candidates) {
  const std::vector<Outline> outlines = OutlinesOf(candidates);
  const std::vector<bool> is_doubtful = FindDoubtful(candidates, RowsOf(outlines));
  const auto rank = [&](std::size_t i) {
    return std::pair(is_doubtful[i] ? 0 : 1, std::lround(candidates[i].slot.confidence / kAsSure));
  };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (!IsGone(candidates[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });
  std::vector<std::size_t> kept;
  for (const std::size_t i : order)
    if (std::none_of(kept.begin(), kept.end(),
                     [&](std::size_t k) { return outlines[i].Excludes(outlines[k]); }))
      kept.push_back(i);
  std::sort(kept.begin(), kept.end());
  std::vector<ParkingSlot> slots;
  slots.reserve(kept.size());
  for (const std::size_t i : kept) {
    slots.push_back(candidates[i].slot);
    slots.back().confidence *= 1 - kDoubt * static_cast<double>(CountBare(candidates[i]));
  }
  return slots;
}

}  // namespace parkade
