#include "server/map_folder/drive_slots_file.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

TEST(DriveSlotsFile, HoldsWhatWasWritten) {
  ParkingSlot slot;
  slot.id = "slot_a";
  slot.corners = {Eigen::Vector3d(0.1, 0, 1), {2.6, 0, 1}, {2.6, 5, 1}, {0.1, 5, 1}};
  slot.kind = SlotKind::kAngled;
  slot.angle = 1.1, slot.confidence = 0.7, slot.num_marked_sides = 1;
  const std::string bytes = EncodeDriveSlots({slot, slot});
  const std::vector<ParkingSlot> read = DecodeDriveSlots(bytes);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].id, slot.id);
  EXPECT_EQ(read[1].corners, slot.corners);
  EXPECT_EQ(read[1].kind, slot.kind);
  EXPECT_EQ(read[1].angle, slot.angle);
  EXPECT_EQ(read[1].confidence, slot.confidence);
  EXPECT_EQ(read[1].num_marked_sides, slot.num_marked_sides);
  EXPECT_THROW(DecodeDriveSlots(bytes.substr(1)), Error);
  EXPECT_THROW(DecodeDriveSlots(bytes + "x"), Error);
}

}  // namespace
}  // namespace parkade
