#include "mapping/evaluation/surface_rise.h"

#include <gtest/gtest.h>

#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

TEST(MedianRise, IsThatOfMostOfTheGround) {
  const SurfaceMap before = MakeSurface(100, 100, 0.1, [](double x, double) { return 0.01 * x; });
  const SurfaceMap after = MakeSurface(
      100, 100, 0.1, [](double x, double) { return 3.2 + 0.01 * x + (x < 3 ? 0.5 : 0); });
  EXPECT_NEAR(MedianRise(before, after, {}).value_or(0), 3.2, 0.01);
  const Rigid3 lifted{Eigen::Quaterniond::Identity(), {0, 0, 3}};
  EXPECT_NEAR(MedianRise(before, after, lifted).value_or(0), 0.2, 0.01);
}

TEST(MedianRise, ComparesDecksThatLieNearestToEachOther) {
  SurfaceMap before{0.1, {}};
  for (const SurfaceCell& cell : MakeSurface(50, 50, 0.1, [](double, double) { return 0.0; }).cells)
    for (const float deck : {0.0F, 2.8F}) {
      before.cells.push_back(cell);
      before.cells.back().height = deck;
    }
  SurfaceMap after = before;
  for (SurfaceCell& cell : after.cells) cell.height += 0.3F;
  EXPECT_NEAR(MedianRise(before, after, {}).value_or(0), 0.3, 1e-5);
}

TEST(MedianRise, SaysNothingWhereTheyDoNotMeet) {
  const SurfaceMap surface = MakeSurface(50, 50, 0.1, [](double, double) { return 0.0; });
  const Rigid3 elsewhere{Eigen::Quaterniond::Identity(), {100, 0, 0}};
  EXPECT_FALSE(MedianRise(surface, surface, elsewhere));
}

}  // namespace
}  // namespace parkade
