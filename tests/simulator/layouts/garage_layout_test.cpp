#include "tests/simulator/layouts/garage_layout.h"

#include <gtest/gtest.h>

#include "tests/simulator/layouts/garage_place.h"

namespace parkade::simulator {
namespace {

TEST(GarageLayout, NothingDrivesUnderWalls) {
  const GarageLayout layout = PlanGarage(5, 0);
  const Place place = MakeGaragePlace(layout, {.seed = 5});

  int num_beside = 0;
  for (double x = 1; x < layout.length - 1; x += 0.5) {
    EXPECT_FALSE(place.is_drivable(0, {x, 0.05}))
        << "the southern wall reaches 10 cm into the deck";
    num_beside += place.is_drivable(0, {x, 0.15});
  }
  EXPECT_GT(num_beside, layout.length / 2) << "ground goes up to it";
  const double aisle = layout.decks[0].aisle_y[0];
  EXPECT_TRUE(place.is_drivable(0, {0.05, aisle})) << "a gate";
  EXPECT_TRUE(place.is_drivable(layout.ForecourtSheet(), {-0.05, aisle}));
  EXPECT_FALSE(place.is_drivable(0, {0.05, aisle + GarageLayout::kGateHalf + 0.5})) << "beside it";
  EXPECT_FALSE(
      place.is_drivable(layout.ForecourtSheet(), {-0.05, aisle + GarageLayout::kGateHalf + 0.5}));
  EXPECT_TRUE(
      place.is_drivable(layout.ForecourtSheet(), {-0.15, aisle + GarageLayout::kGateHalf + 0.5}));
}

TEST(GarageLayout, NothingDrivesThroughTheLampsOnTheForecourt) {
  const GarageLayout layout = PlanGarage(5, 0);
  const Place place = MakeGaragePlace(layout, {.seed = 5});

  ASSERT_FALSE(layout.lamp_feet.empty());
  for (const Rectangle& foot : layout.lamp_feet) {
    EXPECT_FALSE(
        place.is_drivable(layout.ForecourtSheet(), foot.center + Eigen::Vector2d(0.15, 0)));
    EXPECT_TRUE(place.is_drivable(layout.ForecourtSheet(), foot.center + Eigen::Vector2d(0.17, 0)));
  }
}

}  // namespace
}  // namespace parkade::simulator
