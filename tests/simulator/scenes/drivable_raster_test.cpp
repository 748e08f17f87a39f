#include "tests/simulator/scenes/drivable_raster.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/simulator/layouts/plan_place.h"

namespace parkade::simulator {
namespace {

class DrivableRasters : public testing::TestWithParam<const char*> {};

/// Points nearer than 2 mm to where the answer changes are left out: they are asked for in single
/// precision.
TEST_P(DrivableRasters, SayWhatThePlanSays) {
  constexpr double kMargin = 0.002;  // [m]
  const Place place = PlanPlace(GetParam(), {.seed = 5});
  std::mt19937 random(3);
  ASSERT_FALSE(place.ground.sheets().empty());
  for (size_t sheet = 0; sheet < place.ground.sheets().size(); ++sheet) {
    const GroundSheet& ground = place.ground.sheets()[sheet];
    const DrivableRaster raster(place, sheet);
    const auto is_drivable = [&](const Eigen::Vector2d& xy) {
      return ground.Covers(xy) && place.is_drivable(sheet, xy);
    };
    std::uniform_real_distribution<double> x(ground.min.x() + kMargin,
                                             ground.max.x() - 2 * kMargin);
    std::uniform_real_distribution<double> y(ground.min.y() + kMargin,
                                             ground.max.y() - 2 * kMargin);
    int num_checked = 0, num_wrong = 0;
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector2d xy(x(random), y(random));
      const bool expected = is_drivable(xy);
      bool is_plain = true;
      for (const double dx : {-kMargin, 0.0, kMargin})
        for (const double dy : {-kMargin, 0.0, kMargin})
          is_plain = is_plain && is_drivable(xy + Eigen::Vector2d(dx, dy)) == expected;
      if (!is_plain) continue;
      ++num_checked;
      num_wrong += raster.At(static_cast<float>(xy.x()), static_cast<float>(xy.y())) != expected;
    }
    EXPECT_GT(num_checked, 15000) << sheet;
    EXPECT_EQ(num_wrong, 0) << "sheet " << sheet << ", of " << num_checked;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, DrivableRasters, testing::Values("lot", "garage", "street"));

}  // namespace
}  // namespace parkade::simulator
