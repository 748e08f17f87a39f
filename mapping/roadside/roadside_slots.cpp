#include "mapping/roadside/roadside_slots.h"

#include <algorithm>
#include <cmath>

#include "mapping/roadside/lane_slots.h"

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxShare = 0.25;      // of a slot that another one may cover
constexpr double kMaxHeightStep = 1.2;  // [m] between slots of one deck
constexpr double kNear = 15;            // [m] slots farther apart share no ground
constexpr double kMinChord = 0.7;       // of the lane's length within a slot: less is a bend

/// The rectangles of a lane's slots, but for those at which it bends.
std::vector<RoadsideSlot> SlotsOf(const ParkingLane& lane) {
  std::vector<RoadsideSlot> slots;
  const int count = static_cast<int>(lane.places.size());
  const auto place = [&](double along) {
    const int i =
        std::clamp(static_cast<int>(std::lround(along / ParkingLane::kStep)), 0, count - 1);
    return lane.places[static_cast<std::size_t>(i)];
  };
  for (const LaneSlot& found : FindLaneSlots(lane.states, ParkingLane::kStep)) {
    const double quarter = 0.25 * (found.end - found.begin);
    const Vector2d begin = place(found.Middle() - quarter).head<2>(),
                   end = place(found.Middle() + quarter).head<2>();
    const Vector3d middle = place(found.Middle());
    if ((end - begin).norm() < kMinChord * 2 * quarter) continue;
    const Vector2d along = (end - begin).normalized(), left(-along.y(), along.x());
    const Vector2d center = middle.head<2>(), length = 2 * quarter * along,
                   width = 0.5 * ParkingLane::kWidth * left;
    slots.push_back({{center + length + width, center - length + width, center - length - width,
                      center + length - width},
                     middle.z(),
                     found.confidence,
                     found.is_occupied});
  }
  return slots;
}

bool Excludes(const RoadsideSlot& a, const RoadsideSlot& b) {
  return std::abs(a.height - b.height) < kMaxHeightStep &&
         (a.corners[0] - b.corners[0]).norm() < kNear &&
         SharedArea(a.corners, b.corners) >
             kMaxShare * std::min(SignedArea(a.corners), SignedArea(b.corners));
}

}  // namespace

std::vector<RoadsideSlot> FindRoadsideSlots(const CellFinder& cells,
                                            std::span<const DrivenPath> paths) {
  std::vector<RoadsideSlot> found;
  for (const Roadside& roadside : LookBeside(cells, paths))
    for (const RoadsideSlot& slot : SlotsOf(FindParkingLane(roadside))) found.push_back(slot);
  std::stable_sort(found.begin(), found.end(), [](const RoadsideSlot& a, const RoadsideSlot& b) {
    return a.confidence > b.confidence;
  });
  std::vector<RoadsideSlot> kept;
  for (const RoadsideSlot& slot : found)
    if (std::none_of(kept.begin(), kept.end(),
                     [&](const RoadsideSlot& other) { return Excludes(slot, other); }))
      kept.push_back(slot);
  return kept;
}

}  // namespace parkade
