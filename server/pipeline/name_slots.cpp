#include "server/pipeline/name_slots.h"

#include <cmath>
#include <set>

#include "core/files/sha256.h"

namespace parkade {
namespace {

constexpr std::size_t kNumDigits = 10;  // hexadecimal: of a million slots two have one by chance

std::string NameOf(const std::string& text) {
  return "slot_" + Sha256Of(text).substr(0, kNumDigits);
}

std::string TextOf(const std::string& drive, const Eigen::Vector3d& place) {
  const auto steps = [](double value, double step) {
    return " " + std::to_string(std::lround(value / step));
  };
  return drive + steps(place.x(), 0.5) + steps(place.y(), 0.5) + steps(place.z(), 1);
}

}  // namespace

void NameSlots(const std::vector<NamingDrive>& drives, std::vector<ParkingSlot>& slots) {
  std::vector<MovedDrive> moved;
  moved.reserve(drives.size());
  for (const NamingDrive& drive : drives) moved.push_back(drive.odometry_from_site);
  std::set<std::string> taken;
  for (ParkingSlot& slot : slots)
    if (!slot.id.empty() && !taken.insert(slot.id).second) slot.id.clear();
  for (ParkingSlot& slot : slots) {
    if (!slot.id.empty()) continue;
    const std::optional<Carriage> carriage = CarryFrom(slot.Center(), moved);
    std::string text =
        carriage ? TextOf(drives[carriage->drive].name, carriage->after_from_before * slot.Center())
                 : TextOf("", slot.Center());
    while (!taken.insert(NameOf(text)).second) text += "+";
    slot.id = NameOf(text);
  }
}

}  // namespace parkade
