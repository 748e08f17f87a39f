#include "export/lanelet2/parking_lots.h"

#include <gtest/gtest.h>

#include "tests/export/example_map.h"
#include "tests/export/lanelet2/parking_example.h"

namespace parkade {
namespace {

ParkingLots FindLots(const SiteMap& map) {
  return FindParkingLots(FindFreeSheets(map.surface), map.markings.slots, map.surface.cell_size);
}

double TotalArea(const std::vector<LevelRing>& rings, int level) {
  double area = 0;
  for (const LevelRing& one : rings)
    if (one.level == level) area += SignedArea(one.ring);
  return area;
}

TEST(ParkingLots, OfGroundWithoutSlotsAreItsSheets) {
  const SiteMap garage = MakeExampleMap(false);
  const std::vector<FreeSheet> sheets = FindFreeSheets(garage.surface);
  const ParkingLots found = FindParkingLots(sheets, {}, garage.surface.cell_size);

  ASSERT_EQ(found.lots.size(), 2U);
  ASSERT_EQ(found.obstacles.size(), 1U) << "the pillar";
  for (const FreeSheet& sheet : sheets)
    EXPECT_NEAR(TotalArea(found.lots, sheet.level) - TotalArea(found.obstacles, sheet.level),
                sheet.area, 1e-9);
  for (const Eigen::Vector3d& corner : found.obstacles[0].ring)
    EXPECT_NEAR(corner.z(), 0.01 * corner.y(), 0.01 * garage.surface.cell_size + 1e-6);
}

TEST(ParkingLots, TakeInTheirSlots) {
  const ParkingLots found = FindLots(MakeParkingExample(false));

  // The lower deck, the slot beside all ground, the upper deck.
  ASSERT_EQ(found.lots.size(), 3U);
  EXPECT_EQ(found.lots[2].level, 1);
  double highest = 0;
  for (const Eigen::Vector3d& corner : found.lots[0].ring) highest = std::max(highest, corner.y());
  EXPECT_NEAR(highest, 9.5, 0.26) << "the first slot reaches beyond the free ground";
}

TEST(ParkingLots, EncloseObstaclesWithoutHoles) {
  const ParkingLots found = FindLots(MakeParkingExample(false));

  // The pillar, and both halves of the block around the slot. A slot's car is no obstacle.
  ASSERT_EQ(found.obstacles.size(), 3U);
  EXPECT_NEAR(TotalArea(found.obstacles, 0), 1 + 8 * 8 - 2.3 * 4.75, 3.0);
}

TEST(ParkingLots, LeaveOutCrumbsWithoutSlots) {
  FreeSheet crumb;
  crumb.rings = {{{0, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}, {0, 0.5, 0}}};
  EXPECT_TRUE(FindParkingLots({&crumb, 1}, {}, 0.1).lots.empty());
}

}  // namespace
}  // namespace parkade
