#include "mapping/surface/cell_sights.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using Color = std::array<std::uint8_t, 3>;

ColorSight Grey(std::uint8_t value, std::uint8_t rank) { return {value, value, value, rank}; }

TEST(CellSights, TheNearestThatAgreeAreAveraged) {
  CellSights sights;
  EXPECT_TRUE(sights.empty());
  EXPECT_EQ(sights.Color(), (Color{0, 0, 0}));
  sights.Add({.blue = 10, .green = 100, .red = 60, .rank = 200}, true);
  EXPECT_EQ(sights.Color(), (Color{60, 100, 10}));
  sights.Add({.blue = 20, .green = 110, .red = 70, .rank = 190}, false);
  sights.Add({.blue = 30, .green = 120, .red = 80, .rank = 180}, false);
  sights.Add(Grey(255, 199), false);  // a reflection
  EXPECT_EQ(sights.Color(), (Color{70, 110, 20}));
}

TEST(CellSights, FarOnesHaveNoSayBesideOneTwiceAsNear) {
  CellSights sights;
  sights.Add(Grey(100, 60), true);
  sights.Add(Grey(100, 60), false);
  sights.Add(Grey(140, 130), false);
  EXPECT_EQ(sights.Color(), (Color{140, 140, 140}));
}

TEST(CellSights, ALaterDriveDecidesWhereItSawTheCellWell) {
  CellSights sights;
  for (int i = 0; i < 5; ++i) sights.Add(Grey(100, 190), i == 0);
  sights.Add(Grey(160, 50), true);
  EXPECT_EQ(sights.Color(), (Color{160, 160, 160}));
}

TEST(CellSights, ALaterDriveThatSawItFromAfarDoesNot) {
  CellSights sights;
  for (int i = 0; i < 5; ++i) sights.Add(Grey(100, 190), i == 0);
  sights.Add(Grey(160, 11), true);
  EXPECT_EQ(sights.Color(), (Color{100, 100, 100}));
}

}  // namespace
}  // namespace parkade
