#include "mapping/roadside/roadside_slots.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/mapping/roadside/street_world.h"

namespace parkade {
namespace {

std::vector<RoadsideSlot> Find(const SurfaceMap& surface, const std::vector<DrivenPath>& paths) {
  std::vector<RoadsideSlot> slots = FindRoadsideSlots(CellFinder(surface), paths);
  std::sort(slots.begin(), slots.end(), [](const RoadsideSlot& a, const RoadsideSlot& b) {
    return a.corners[0].x() < b.corners[0].x();
  });
  return slots;
}

TEST(FindRoadsideSlots, ARowOfCarsAndWhatIsFreeInIt) {
  const SurfaceMap surface = StreetWithCars(40, {10, 16.2, 28.6});
  const std::vector<RoadsideSlot> slots = Find(surface, {PathAlongStreet(32)});
  ASSERT_EQ(slots.size(), 6U) << "three cars, a free place, and one beyond each end";
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const Eigen::Vector2d middle = 0.5 * (slots[i].corners[0] + slots[i].corners[2]);
    EXPECT_NEAR(middle.x(), 3.8 + 6.2 * static_cast<double>(i), 0.4);
    EXPECT_NEAR(middle.y(), -4, 0.2);
    EXPECT_NEAR(SignedArea(slots[i].corners), 6.2 * 2, 0.5);
    EXPECT_NEAR(slots[i].corners[0].y(), -3, 0.2) << "the first two lie at the lane";
    EXPECT_NEAR(slots[i].corners[1].y(), -3, 0.2);
  }
  EXPECT_TRUE(slots[1].is_occupied);
  EXPECT_FALSE(slots[3].is_occupied);
}

TEST(FindRoadsideSlots, TwoPassesFindEachSlotOnce) {
  const SurfaceMap surface = StreetWithCars(40, {10, 16.2, 28.6});
  const DrivenPath path = PathAlongStreet(32);
  EXPECT_EQ(Find(surface, {path, path}).size(), Find(surface, {path}).size());
}

TEST(FindRoadsideSlots, AStreetWithoutCarsHasNone) {
  EXPECT_TRUE(Find(StreetWithCars(40, {}), {PathAlongStreet(32)}).empty());
}

TEST(IsMarked, ParallelSlotsWithoutLinesAreNot) {
  EXPECT_TRUE(IsMarked({.kind = SlotKind::kPerpendicular}));
  EXPECT_TRUE(IsMarked({.kind = SlotKind::kParallel, .num_marked_sides = 1}));
  EXPECT_FALSE(IsMarked({.kind = SlotKind::kParallel}));
}

}  // namespace
}  // namespace parkade
