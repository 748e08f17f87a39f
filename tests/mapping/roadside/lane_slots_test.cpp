#include "mapping/roadside/lane_slots.h"

#include <gtest/gtest.h>

#include <utility>

namespace parkade {
namespace {

constexpr double kStep = 0.2;  // [m]

/// A lane of stretches: what each holds, and its length [m].
std::vector<LaneSlot> Find(const std::vector<std::pair<LaneState, double>>& stretches) {
  std::vector<LaneState> states;
  double end = 0;
  for (const auto& [state, length] : stretches)
    for (end += length; static_cast<double>(states.size()) * kStep < end - 1e-6;)
      states.push_back(state);
  return FindLaneSlots(states, kStep);
}

constexpr LaneState kFree = LaneState::kFree, kCar = LaneState::kVehicle,
                    kUnseen = LaneState::kUnseen, kBlocked = LaneState::kBlocked;

TEST(FindLaneSlots, CarsOfARowTakeOneSlotEach) {
  const auto slots = Find({{kUnseen, 10},
                           {kCar, 4.6},
                           {kFree, 1.6},
                           {kCar, 4.6},
                           {kFree, 1.6},
                           {kCar, 4.6},
                           {kUnseen, 10}});
  ASSERT_EQ(slots.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(slots[i].Middle(), 12.3 + 6.2 * static_cast<double>(i), 0.15);
    EXPECT_NEAR(slots[i].end - slots[i].begin, 6.2, 0.1);
    EXPECT_TRUE(slots[i].is_occupied);
    EXPECT_GT(slots[i].confidence, 0.8);
  }
}

TEST(FindLaneSlots, APlaceThatFitsACarBetweenTwoIsASlotLessSurely) {
  const auto slots = Find({{kUnseen, 10}, {kCar, 4.6}, {kFree, 7.8}, {kCar, 4.6}, {kUnseen, 10}});
  ASSERT_EQ(slots.size(), 3U);
  EXPECT_FALSE(slots[1].is_occupied);
  EXPECT_NEAR(slots[1].Middle(), 18.5, 0.3);
  EXPECT_LT(slots[1].confidence, slots[0].confidence);
}

TEST(FindLaneSlots, WhatNobodySawOrStandsInTheWayIsNone) {
  for (const LaneState between : {kUnseen, kBlocked}) {
    const auto slots = Find({{kCar, 4.6}, {kFree, 0.8}, {between, 6.2}, {kFree, 0.8}, {kCar, 4.6}});
    EXPECT_EQ(slots.size(), 2U);
  }
}

TEST(FindLaneSlots, BeyondTheEndOfARowIsASlotUnlessAJunctionFollows) {
  const auto count = [](double clear) {
    return Find({{kUnseen, 9},
                 {kCar, 4.6},
                 {kFree, 1.6},
                 {kCar, 4.6},
                 {kFree, clear},
                 {kBlocked, 12}})
        .size();
  };
  EXPECT_EQ(count(13), 3U);
  EXPECT_EQ(count(9), 2U) << "nobody parks within five meters of it";
}

TEST(FindLaneSlots, ALoneCarIsLessSureThanARow) {
  const auto slots = Find({{kUnseen, 9}, {kCar, 4.6}, {kUnseen, 9}});
  ASSERT_EQ(slots.size(), 1U);
  EXPECT_LT(slots[0].confidence, 0.8);
}

TEST(FindLaneSlots, CarsBumperToBumperAreTwo) {
  const auto slots = Find({{kUnseen, 9}, {kCar, 10.4}, {kUnseen, 9}});
  ASSERT_EQ(slots.size(), 2U);
  EXPECT_NEAR(slots[0].Middle(), 11.6, 0.5);
  EXPECT_NEAR(slots[1].Middle(), 16.8, 0.5);
}

TEST(FindLaneSlots, WhatIsShorterThanACarIsNone) {
  EXPECT_TRUE(Find({{kFree, 20}, {kCar, 1.8}, {kFree, 20}}).empty());
  EXPECT_TRUE(FindLaneSlots({}, kStep).empty());
}

TEST(FindLaneSlots, ARowThatBeginsAnewHasItsOwnPlaces) {
  // Three cars, then two that stand half a slot off that row.
  const auto slots = Find({{kUnseen, 9},
                           {kCar, 4.6},
                           {kFree, 1.6},
                           {kCar, 4.6},
                           {kFree, 1.6},
                           {kCar, 4.6},
                           {kUnseen, 4.6},
                           {kCar, 4.6},
                           {kFree, 1.6},
                           {kCar, 4.6},
                           {kUnseen, 9}});
  ASSERT_EQ(slots.size(), 5U);
  EXPECT_NEAR(slots[2].Middle(), 23.7, 0.2);
  EXPECT_NEAR(slots[3].Middle(), 32.9, 0.2);
}

}  // namespace
}  // namespace parkade
