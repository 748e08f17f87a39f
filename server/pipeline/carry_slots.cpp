#include "server/pipeline/carry_slots.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace parkade {
namespace {

constexpr double kNear = 15;      // [m] from which ground is seen well enough to hold slots
constexpr double kDeck = 2;       // [m] between a pose and ground of another deck
constexpr double kOffDeck = 1e3;  // [m] that such a pose counts as farther away

double DistanceTo(const Eigen::Vector3d& place, const TrajectoryState& state) {
  const Eigen::Vector3d offset = state.world_from_body.translation - place;
  return offset.head<2>().norm() + (std::abs(offset.z()) > kDeck ? kOffDeck : 0);
}

}  // namespace

std::optional<Carriage> CarryFrom(const Eigen::Vector3d& place,
                                  std::span<const MovedDrive> drives) {
  std::optional<Carriage> carriage;
  double nearest = std::numeric_limits<double>::max();
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < drives.size(); ++i)
    for (const TrajectoryState& state : drives[i].before.states()) {
      const double distance = DistanceTo(place, state);
      if (distance > std::max(kNear, nearest)) continue;
      const std::optional<Rigid3> after = drives[i].after.At(state.time);
      if (!after) continue;
      const Rigid3 after_from_before = *after * state.world_from_body.Inverse();
      if (distance < kNear) places.push_back(after_from_before * place);
      if (distance < nearest) nearest = distance, carriage = Carriage{after_from_before, i, 0};
    }
  for (const Eigen::Vector3d& other : places)
    carriage->spread =
        std::max(carriage->spread, (other - carriage->after_from_before * place).norm());
  return carriage;
}

ParkingSlot Moved(ParkingSlot slot, const Rigid3& after_from_before) {
  for (Eigen::Vector3d& corner : slot.corners) corner = after_from_before * corner;
  return slot;
}

}  // namespace parkade
