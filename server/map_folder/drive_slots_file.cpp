#include "server/map_folder/drive_slots_file.h"

#include "core/files/binary_archive.h"

namespace parkade {

// Found by argument-dependent lookup, hence in the type's own namespace.
template <typename A>
void Serialize(A& archive, ParkingSlot& slot) {
  archive(slot.id, slot.corners, slot.kind, slot.angle, slot.confidence, slot.num_marked_sides);
}

std::string EncodeDriveSlots(std::vector<ParkingSlot> slots) {
  BinaryWriter writer;
  writer(slots);
  return writer.bytes();
}

std::vector<ParkingSlot> DecodeDriveSlots(std::string_view bytes) {
  BinaryReader reader(bytes);
  std::vector<ParkingSlot> slots;
  reader(slots);
  Require(reader.is_at_end(), ErrorCode::kInvalidInput, "it is longer than it says");
  return slots;
}

}  // namespace parkade
