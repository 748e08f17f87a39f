#include "mapping/markings/slot_states.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using Eigen::Vector3d;

/// Five meters by two and a half, from (x, 0, height).
ParkingSlot SlotAt(double x, double height = 0) {
  ParkingSlot slot;
  slot.corners = {
      Vector3d(x, 0, height), {x + 2.5, 0, height}, {x + 2.5, 5, height}, {x, 5, height}};
  return slot;
}

/// What a drive saw of [low_x, high_x] x [low_y, high_y], every ten centimeters; the body lies
/// above the site's origin.
PosedGroundPatch PatchOf(int drive, bool is_free, double low_x, double high_x, double low_y,
                         double high_y, double height = 0) {
  PosedGroundPatch posed;
  posed.patch.drive = drive;
  posed.site_from_body.translation.z() = height;
  for (double x = low_x + 0.05; x < high_x; x += 0.1)
    for (double y = low_y + 0.05; y < high_y; y += 0.1) {
      GroundSample sample;
      sample.point_in_body = Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 0);
      sample.is_free = is_free;
      posed.patch.samples.push_back(sample);
    }
  return posed;
}

TEST(SlotStates, AreWhatEachDriveSaw) {
  std::vector<ParkingSlot> slots = {SlotAt(0), SlotAt(2.5)};
  const std::vector<PosedGroundPatch> patches = {
      PatchOf(0, true, 0, 5, -2, 5),  // both are empty
      PatchOf(1, true, 0, 5, -2, 0.4),
      PatchOf(1, false, 0.4, 2.2, 0.5, 0.8),  // a car's front in the first one
      PatchOf(1, true, 2.5, 5, 0, 5)};
  SeeSlots(PatchesInMemory(patches), {}, 3, slots);
  EXPECT_EQ(slots[0].states,
            (std::vector{SlotState::kFree, SlotState::kOccupied, SlotState::kUnseen}));
  EXPECT_EQ(slots[1].states, (std::vector{SlotState::kFree, SlotState::kFree, SlotState::kUnseen}));
}

TEST(SlotStates, WhatIsKnownIsNotLookedForAgain) {
  std::vector<ParkingSlot> slots = {SlotAt(0), SlotAt(20)};
  const std::vector<PosedGroundPatch> patches = {
      PatchOf(0, true, 0, 5, 0, 5), PatchOf(1, true, 0, 5, 0, 5), PatchOf(1, true, 20, 25, 0, 5)};
  const std::vector<KnownStates> known = {{SlotState::kOccupied}, {}};
  SeeSlots(PatchesInMemory(patches), {}, 2, slots, known);
  EXPECT_EQ(slots[0].states, (std::vector{SlotState::kOccupied, SlotState::kFree}));
  EXPECT_EQ(slots[1].states, (std::vector{SlotState::kUnseen, SlotState::kFree}));
}

TEST(SlotStates, WhatStandsBesideTheSlotDoesNotTakeIt) {
  std::vector<ParkingSlot> slots = {SlotAt(0)};
  const std::vector<PosedGroundPatch> patches = {PatchOf(0, true, 0.2, 2.5, 0, 5),
                                                 PatchOf(0, false, -1, 0.2, 0, 5),
                                                 PatchOf(0, false, 0, 2.5, -1, 0.3)};
  SeeSlots(PatchesInMemory(patches), {}, 1, slots);
  EXPECT_EQ(slots[0].states[0], SlotState::kFree);
}

TEST(SlotStates, OfManyViewsTheNearestAreRead) {
  // A car was seen from far away, before it left: from near the slot is empty.
  std::vector<PosedGroundPatch> patches(40, PatchOf(0, false, 0, 2.5, 0, 5));
  for (PosedGroundPatch& far : patches) {
    far.site_from_body.translation.x() = -10;
    for (GroundSample& sample : far.patch.samples)
      sample.point_in_body =
          Eigen::Vector3f(sample.point_in_body.x() + 10, sample.point_in_body.y(), 0);
  }
  patches.insert(patches.end(), 40, PatchOf(0, true, 0, 2.5, 0, 5));
  std::vector<ParkingSlot> slots = {SlotAt(0)};
  SeeSlots(PatchesInMemory(patches), {}, 1, slots);
  EXPECT_EQ(slots[0].states[0], SlotState::kFree);
}

TEST(SlotStates, ViewsOfAnotherDeckDoNotTakeTheirPlace) {
  std::vector<PosedGroundPatch> patches(50, PatchOf(0, true, 0, 2.5, 0, 5, 2.4));
  for (PosedGroundPatch& far : patches) far.site_from_body.translation.x() = 0.1;
  patches.push_back(PatchOf(0, true, 0, 2.5, 0, 5));
  patches.back().site_from_body.translation.x() = -0.5;
  for (GroundSample& sample : patches.back().patch.samples)
    sample.point_in_body =
        Eigen::Vector3f(sample.point_in_body.x() + 0.5F, sample.point_in_body.y(), 0);
  std::vector<ParkingSlot> slots = {SlotAt(0)};
  SeeSlots(PatchesInMemory(patches), {}, 1, slots);
  EXPECT_EQ(slots[0].states[0], SlotState::kFree);
}

// The body lies high above the ground on which the car stands, and the ramp under the car goes on
// through the slot.
TEST(SlotStates, DecksAreToldByThePlaneUnderTheCar) {
  constexpr double kBody = 1.6, kSlope = 0.1;
  const double pitch = std::atan(kSlope);
  DrivenPath path;
  path.body_from_ground.translation.z() = -kBody;
  std::vector<PosedGroundPatch> patches = {PatchOf(0, true, 10, 12.5, 0, 5)};
  Rigid3& site_from_body = patches[0].site_from_body;
  site_from_body.rotation = ExpSo3({0, -pitch, 0});
  site_from_body.translation = site_from_body.rotation * Vector3d(0, 0, kBody);
  for (GroundSample& sample : patches[0].patch.samples)
    sample.point_in_body = Eigen::Vector3f(sample.point_in_body.x(), sample.point_in_body.y(),
                                           static_cast<float>(-kBody));
  std::vector<ParkingSlot> slots = {SlotAt(10, 11 * kSlope), SlotAt(10, 11 * kSlope - 2.4)};
  SeeSlots(PatchesInMemory(patches), std::span(&path, 1), 1, slots);
  EXPECT_EQ(slots[0].states[0], SlotState::kFree);
  EXPECT_EQ(slots[1].states[0], SlotState::kUnseen);
}

TEST(SlotStates, OtherDecksDoNotCount) {
  std::vector<ParkingSlot> slots = {SlotAt(0), SlotAt(0, 3)};
  SeeSlots(PatchesInMemory(std::vector{PatchOf(0, true, 0, 2.5, 0, 5, 3)}), {}, 1, slots);
  EXPECT_EQ(slots[0].states[0], SlotState::kUnseen);
  EXPECT_EQ(slots[1].states[0], SlotState::kFree);
}

}  // namespace
}  // namespace parkade
