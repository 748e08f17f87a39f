#include "tests/simulator/scenes/traffic.h"

#include <gtest/gtest.h>

#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/layouts/plan_place.h"

namespace parkade::simulator {
namespace {

class Traffic : public testing::TestWithParam<const char*> {
 protected:
  /// A scene without its looks: traffic needs but the place.
  static Scene BareScene(const Place& place) { return {.place = place, .sky = Sky(1)}; }
};

TEST_P(Traffic, MovesAndKeepsClearOfTheOwnCar) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Scene scene = BareScene(PlanPlace(GetParam(), {.seed = seed}));
    const DrivePlan plan = PlanDrive(scene.place, 60, seed);
    AddTraffic(scene, plan.motion, 4, seed);

    EXPECT_GE(scene.movers.movers.size(), 4u);
    double nearest = 1e9, longest = 0;
    for (double time = 0; time < 60; time += 0.23)
      nearest = std::min(nearest, TrafficClearance(scene, plan.motion, time));
    for (const Mover& mover : scene.movers.movers)
      longest = std::max(
          longest,
          (mover.world_from_mover(30).translation - mover.world_from_mover(20).translation).norm());
    EXPECT_GT(nearest, 0.6) << seed;
    EXPECT_LT(nearest, 25) << "somebody is to be seen, seed " << seed;
    EXPECT_GT(longest, 5) << seed;
  }
}

TEST_P(Traffic, StaysOnTheGroundAndMovesWithoutJumps) {
  Scene scene = BareScene(PlanPlace(GetParam(), {.seed = 7}));
  const DrivePlan plan = PlanDrive(scene.place, 40, 7);
  AddTraffic(scene, plan.motion, 3, 7);

  ASSERT_FALSE(scene.movers.movers.empty());
  for (const Mover& mover : scene.movers.movers) {
    for (double time = 0.5; time < 39; time += 0.37) {
      const Rigid3 now = mover.world_from_mover(time), soon = mover.world_from_mover(time + 0.02);
      EXPECT_LT((soon.translation - now.translation).norm(), 0.2) << time;
      if (mover.half_size.x() <= 0) continue;  // legs hang from the hip
      const double ground =
          scene.place.ground.Height(now.translation.head<2>(), now.translation.z());
      EXPECT_NEAR(now.translation.z(), ground, 0.16) << time;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Traffic, testing::Values("lot", "garage", "street"));

}  // namespace
}  // namespace parkade::simulator
