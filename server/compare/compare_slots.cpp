#include "server/compare/compare_slots.h"

#include <cmath>

#include "mapping/ground/quadrilateral.h"

namespace parkade {
namespace {

constexpr double kMinOverlap = 0.5;        // intersection over union
constexpr double kMinOverlapOfName = 0.2;  // the same for slots of one id
constexpr double kMaxHeightGap = 1.0;      // [m]

Quadrilateral OutlineIn(const ParkingSlot& slot, const Rigid3& target_from_source) {
  Quadrilateral shape;
  for (size_t i = 0; i < 4; ++i) shape[i] = (target_from_source * slot.corners[i]).head<2>();
  return shape;
}

SlotState StateOf(const StoredSlot& stored) {
  for (auto state = stored.slot.states.rbegin(); state != stored.slot.states.rend(); ++state)
    if (*state != SlotState::kUnseen) return *state;
  return SlotState::kUnseen;
}

}  // namespace

SlotChanges CompareSlots(const std::vector<StoredSlot>& from, const std::vector<StoredSlot>& to,
                         const Rigid3& to_from_from) {
  SlotChanges changes;
  std::vector<bool> is_kept(from.size());
  for (const StoredSlot& later : to) {
    const Quadrilateral outline = OutlineIn(later.slot, {});
    size_t best = from.size();
    double best_rank = 0;
    for (size_t i = 0; i < from.size(); ++i) {
      const Eigen::Vector3d center = to_from_from * from[i].slot.Center();
      if (is_kept[i] || std::abs(center.z() - later.slot.Center().z()) > kMaxHeightGap) continue;
      const double overlap = OverlapOf(outline, OutlineIn(from[i].slot, to_from_from));
      const bool has_name = from[i].id == later.id;
      if (overlap < (has_name ? kMinOverlapOfName : kMinOverlap)) continue;
      const double rank = overlap + (has_name ? 1 : 0);
      if (rank > best_rank) best = i, best_rank = rank;
    }
    if (best == from.size()) {
      changes.added.push_back(later.id);
      continue;
    }
    is_kept[best] = true;
    ++changes.num_kept;
    const SlotState before = StateOf(from[best]), now = StateOf(later);
    if (before != now && before != SlotState::kUnseen && now != SlotState::kUnseen)
      changes.changed.push_back({later.id, before, now});
  }
  for (size_t i = 0; i < from.size(); ++i)
    if (!is_kept[i]) changes.removed.push_back(from[i].id);
  return changes;
}

}  // namespace parkade
