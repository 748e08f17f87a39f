#include "mapping/markings/merge_slots.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using Eigen::Vector3d;

constexpr PaintSeen kBare = PaintSeen::kBare, kPainted = PaintSeen::kPainted,
                    kUnknown = PaintSeen::kUnknown;

/// Two and a half meters by five, from (x, 0).
ParkingSlot SlotAt(double x, double confidence = 0.8, const std::string& id = "") {
  ParkingSlot slot;
  slot.id = id;
  slot.corners = {Vector3d(x, 0, 0), {x + 2.5, 0, 0}, {x + 2.5, 5, 0}, {x, 5, 0}};
  slot.confidence = confidence;
  return slot;
}

/// A slot that the first of two drives found; what the second saw there.
SlotCandidate FoundBefore(double x, SlotSides sides, SlotState seen = SlotState::kFree) {
  SlotCandidate candidate{SlotAt(x, 0.8, "old"), 0, sides};
  candidate.slot.states = {SlotState::kFree, seen};
  return candidate;
}

SlotCandidate FoundNow(double x, double confidence) {
  SlotCandidate candidate{SlotAt(x, confidence, "new"), 1, {kPainted, kPainted}};
  candidate.slot.states = {SlotState::kFree, SlotState::kFree};
  return candidate;
}

TEST(MatchLooks, OneSlotOfSeveralLooksKeepsItsFirstNameAndItsSurestShape) {
  const SlotLook first{{SlotAt(0, 0.5, "a"), SlotAt(2.5, 0.9, "b")}, 0};
  const SlotLook second{{SlotAt(2.6, 0.7, "c"), SlotAt(0.4, 0.6, "d"), SlotAt(20, 0.6, "e")}, 1};
  const std::vector<SlotCandidate> all = MatchLooks(std::vector{first, second});
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].slot.id, "a");
  EXPECT_EQ(all[0].slot.corners[0].x(), 0.4) << "the surer one";
  EXPECT_EQ(all[1].slot.id, "b");
  EXPECT_EQ(all[1].slot.corners[0].x(), 2.5);
  EXPECT_EQ(all[2].slot.id, "e");
  for (const SlotCandidate& candidate : all) EXPECT_EQ(candidate.last_drive, 1);
}

TEST(MatchLooks, ASlotReadFromAFileGivesWayToTheSameOneFoundAgain) {
  const SlotLook rounded{{SlotAt(0.001, 0.87, "a")}, 0}, found{{SlotAt(0.0004, 0.866)}, 0};
  const std::vector<SlotCandidate> all = MatchLooks(std::vector{rounded, found});
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].slot.id, "a");
  EXPECT_EQ(all[0].slot.corners[0].x(), 0.0004);
}

TEST(MatchLooks, WhatDrivesSawInASlotIsKnownUntilItMoves) {
  SlotLook before{{SlotAt(0, 0.5), SlotAt(10, 0.5), SlotAt(20, 0.9)}, 1, true, {true, false}};
  for (ParkingSlot& slot : before.slots) slot.states = {SlotState::kOccupied, SlotState::kUnseen};
  before.slots[2].states.clear();
  const SlotLook now{{SlotAt(0.1, 0.6), SlotAt(10.4, 0.6), SlotAt(20, 0.5)}, 2};
  const std::vector<SlotCandidate> all = MatchLooks(std::vector{before, now});
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].known, (KnownStates{SlotState::kOccupied, std::nullopt}));
  EXPECT_TRUE(all[1].known.empty()) << "it lies elsewhere now";
  EXPECT_TRUE(all[2].known.empty()) << "nothing was said of it";
}

TEST(MatchLooks, ARowLaidOutAnewIsNotTheOldOne) {
  const SlotLook before{{SlotAt(0, 0.8, "a"), SlotAt(2.5, 0.8, "b")}, 0};
  const SlotLook after{{SlotAt(1.25, 0.8, "c")}, 1};
  EXPECT_EQ(MatchLooks(std::vector{before, after}).size(), 3U);
}

TEST(MatchLooks, ALookThatOnlyNamesMakesNoSlots) {
  const SlotLook names{{SlotAt(0, 1, "a"), SlotAt(9, 1, "gone")}, -1, false};
  const std::vector<SlotCandidate> all =
      MatchLooks(std::vector{names, SlotLook{{SlotAt(0.1, 0.5, "b")}, 0}});
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].slot.id, "a");
  EXPECT_EQ(all[0].slot.corners[0].x(), 0.1) << "where it is now";
}

TEST(ChooseSlots, ASlotThatNoLineDividesStaysWhereNoLineIs) {
  SlotCandidate along_kerb = FoundBefore(0, {kBare, kBare});
  along_kerb.slot.kind = SlotKind::kParallel;
  const std::vector<ParkingSlot> slots = ChooseSlots({along_kerb});
  ASSERT_EQ(slots.size(), 1U);
  EXPECT_EQ(slots[0].id, "old");
  EXPECT_EQ(slots[0].confidence, 0.8);
  along_kerb.slot.num_marked_sides = 1;
  EXPECT_TRUE(ChooseSlots({along_kerb}).empty()) << "its line was taken away";
}

TEST(ChooseSlots, WhatIsNotClearlyGoneStays) {
  const auto count = [](const SlotCandidate& candidate) { return ChooseSlots({candidate}).size(); };
  EXPECT_EQ(count(FoundBefore(0, {kUnknown, kUnknown})), 1U);
  EXPECT_EQ(count(FoundBefore(0, {kBare, kUnknown})), 1U) << "the other line may be there";
  EXPECT_EQ(count(FoundBefore(0, {kBare, kBare}, SlotState::kOccupied)), 1U) << "a car hides it";
  EXPECT_EQ(count(FoundBefore(0, {kBare, kBare}, SlotState::kUnseen)), 1U);
  EXPECT_EQ(count(FoundBefore(0, {kBare, kBare})), 0U);
  SlotCandidate found_again = FoundBefore(0, {kBare, kBare});
  found_again.last_drive = 1;
  EXPECT_EQ(count(found_again), 1U) << "the drive that saw it free found it";
}

TEST(ChooseSlots, ABareLineTakesConfidence) {
  EXPECT_EQ(ChooseSlots({FoundBefore(0, {kPainted, kUnknown})}).at(0).confidence, 0.8);
  EXPECT_LT(ChooseSlots({FoundBefore(0, {kPainted, kBare})}).at(0).confidence, 0.8);
}

TEST(ChooseSlots, WhatShadowsMakeOfAHiddenRowDoesNotReplaceIt) {
  const auto slots = ChooseSlots(
      {FoundBefore(0, {kUnknown, kUnknown}, SlotState::kOccupied), FoundNow(1.25, 0.8)});
  ASSERT_EQ(slots.size(), 1U);
  EXPECT_EQ(slots[0].id, "old");
}

TEST(ChooseSlots, ASlotWithABareLineGivesWay) {
  const auto slots = ChooseSlots({FoundBefore(0, {kPainted, kBare}), FoundNow(1.25, 0.5)});
  ASSERT_EQ(slots.size(), 1U);
  EXPECT_EQ(slots[0].id, "new");
}

TEST(ChooseSlots, WhereMostOfARowIsGoneItsHiddenSlotsGiveWay) {
  const std::vector<SlotCandidate> candidates = {
      FoundBefore(0, {kBare, kBare}), FoundBefore(2.5, {kBare, kBare}),
      FoundBefore(5, {kUnknown, kUnknown}, SlotState::kOccupied), FoundNow(6.25, 0.5),
      FoundBefore(30, {kUnknown, kUnknown}, SlotState::kOccupied)};
  const auto slots = ChooseSlots(candidates);
  ASSERT_EQ(slots.size(), 2U);
  EXPECT_EQ(slots[0].id, "new");
  EXPECT_EQ(slots[1].corners[0].x(), 30) << "a row of its own";
}

}  // namespace
}  // namespace parkade
