#include "server/compare/compare_slots.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files/file.h"
#include "export/markings.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using Eigen::Vector3d;

ParkingSlot SlotAt(double x, std::vector<SlotState> states) {
  ParkingSlot slot;
  slot.corners = {Vector3d(x, 0, 1), {x + 2.5, 0, 1}, {x + 2.5, 5, 1}, {x, 5, 1}};
  slot.id = "slot_" + std::to_string(x);
  slot.confidence = 0.5;
  slot.states = std::move(states);
  return slot;
}

/// The slots as a map on disk has them.
std::vector<StoredSlot> Stored(const std::vector<ParkingSlot>& slots,
                               const std::vector<std::string>& drives,
                               const std::optional<SiteDatum>& datum) {
  const TemporaryRoot root;
  const std::filesystem::path file = root.path() / "slots.geojson";
  WriteFileAtomically(file, EncodeSlotsGeoJson(slots, drives, {}, datum));
  return ReadSlots(file, datum);
}

TEST(SlotsFile, HoldsWhatWasWritten) {
  for (const std::optional<SiteDatum>& datum :
       {std::optional<SiteDatum>{}, {SiteDatum{48, 11, 500}}, {SiteDatum{48, 11, 0, false}}}) {
    const ParkingSlot slot = SlotAt(3, {SlotState::kOccupied, SlotState::kUnseen});
    const std::vector<StoredSlot> stored = Stored({slot}, {"b", "a"}, datum);
    ASSERT_EQ(stored.size(), 1U);
    for (size_t i = 0; i < 4; ++i)
      EXPECT_LT((stored[0].slot.corners[i] - slot.corners[i]).norm(), 0.002);
    EXPECT_EQ(stored[0].slot.kind, SlotKind::kPerpendicular);
    EXPECT_EQ(stored[0].slot.states, slot.states) << "in the order of the drives";
    EXPECT_EQ(stored[0].states.at("b"), SlotState::kOccupied);
  }
}

TEST(SlotsFile, SomethingElseIsRefused) {
  const TemporaryRoot root;
  const std::filesystem::path file = root.path() / "slots.geojson";
  for (const char* text :
       {"", "[]", R"({"features": 1})", R"({"features": [{"geometry": null}]})"}) {
    WriteFileAtomically(file, text);
    EXPECT_THROW(ReadSlots(file, {}), Error) << text;
    EXPECT_THROW(ReadTrueSlots(file, {}), Error) << text;
  }
}

TEST(CompareSlots, TellsWhichCameWentAndWereTaken) {
  const Rigid3 to_from_from{Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitZ())),
                            Vector3d(7, -3, 0.5)};
  const std::vector<StoredSlot> from =
      Stored({SlotAt(0, {SlotState::kFree}), SlotAt(2.5, {SlotState::kFree}),
              SlotAt(5, {SlotState::kOccupied}), SlotAt(20, {SlotState::kFree})},
             {"monday"}, {});
  std::vector<ParkingSlot> later = {SlotAt(0.1, {SlotState::kFree, SlotState::kOccupied}),
                                    SlotAt(2.5, {SlotState::kFree, SlotState::kUnseen}),
                                    SlotAt(5, {SlotState::kOccupied, SlotState::kFree}),
                                    SlotAt(40, {SlotState::kUnseen, SlotState::kFree})};
  for (ParkingSlot& slot : later)
    for (Vector3d& corner : slot.corners) corner = to_from_from * corner;
  const std::vector<StoredSlot> to = Stored(later, {"monday", "tuesday"}, {});

  const SlotChanges changes = CompareSlots(from, to, to_from_from);
  EXPECT_EQ(changes.num_kept, 3U);
  EXPECT_EQ(changes.added, std::vector{to[3].id});
  EXPECT_EQ(changes.removed, std::vector{from[3].id});
  ASSERT_EQ(changes.changed.size(), 2U);
  EXPECT_EQ(changes.changed[0].id, to[0].id);
  EXPECT_EQ(changes.changed[0].to, SlotState::kOccupied);
  EXPECT_EQ(changes.changed[1].to, SlotState::kFree);
}

TEST(CompareSlots, OneIdIsOneSlotEvenWhereItIsFoundShorter) {
  ParkingSlot whole = SlotAt(0, {SlotState::kFree}), part = whole;
  part.corners = {Vector3d(0, 0, 1), {2.5, 0, 1}, {2.5, 2, 1}, {0, 2, 1}};
  const auto compare = [&] {
    return CompareSlots(Stored({whole}, {"monday"}, {}), Stored({part}, {"monday"}, {}), {});
  };
  EXPECT_EQ(compare().num_kept, 1U);
  part.id = "slot_b";
  EXPECT_EQ(compare().num_kept, 0U);
  part = SlotAt(20, {SlotState::kFree});
  part.id = whole.id;
  EXPECT_EQ(compare().num_kept, 0U) << "ids of older versions of this program say little";
}

}  // namespace
}  // namespace parkade
