#include "mapping/surface/cell_color.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using Color = std::array<std::uint8_t, 3>;

ColorObservation Gray(std::uint8_t value, std::uint8_t rank) { return {value, value, value, rank}; }

TEST(CellColor, TheNearestThatAgreeAreAveraged) {
  CellColor observations;
  EXPECT_TRUE(observations.empty());
  EXPECT_EQ(observations.Color(), (Color{0, 0, 0}));
  observations.Add({.blue = 10, .green = 100, .red = 60, .rank = 200}, true);
  EXPECT_EQ(observations.Color(), (Color{60, 100, 10}));
  observations.Add({.blue = 20, .green = 110, .red = 70, .rank = 190}, false);
  observations.Add({.blue = 30, .green = 120, .red = 80, .rank = 180}, false);
  observations.Add(Gray(255, 199), false);  // a reflection
  EXPECT_EQ(observations.Color(), (Color{70, 110, 20}));
}

TEST(CellColor, FarOnesHaveNoSayBesideOneTwiceAsNear) {
  CellColor observations;
  observations.Add(Gray(100, 60), true);
  observations.Add(Gray(100, 60), false);
  observations.Add(Gray(140, 130), false);
  EXPECT_EQ(observations.Color(), (Color{140, 140, 140}));
}

TEST(CellColor, ALaterDriveDecidesWhereItSawTheCellWell) {
  CellColor observations;
  for (int i = 0; i < 5; ++i) observations.Add(Gray(100, 190), i == 0);
  observations.Add(Gray(160, 50), true);
  EXPECT_EQ(observations.Color(), (Color{160, 160, 160}));
}

TEST(CellColor, ALaterDriveThatSawItFromAfarDoesNot) {
  CellColor observations;
  for (int i = 0; i < 5; ++i) observations.Add(Gray(100, 190), i == 0);
  observations.Add(Gray(160, 11), true);
  EXPECT_EQ(observations.Color(), (Color{100, 100, 100}));
}

}  // namespace
}  // namespace parkade
