#include "tests/simulator/scenes/mover_scene.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "tests/simulator/render/renderer.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

constexpr double kSpeed = 8;  // [m/s]

/// Black drivable ground, and a white ball that flies past the left camera, half a meter up.
Scene BallWorld(bool has_ball) {
  Scene scene{.place = {},
              .sky = Sky(1, Weather::kOvercast),
              .ground_colors = {GroundCanvas({-1, -1}, {1, 1}, 0.1)},
              .materials = {Material{.albedo = Gray(0.9f)}}};
  scene.place.ground = Ground({{.min = {-40, -40},
                                .max = {40, 40},
                                .height = [](const Eigen::Vector2d&) { return 0.0; },
                                .covers = {}}});
  scene.place.is_drivable = [](size_t, const Eigen::Vector2d&) { return true; };
  scene.ground_colors[0].Finish();
  scene.ground.AddQuad({{{-40, -40, 0}, {40, -40, 0}, {40, 40, 0}, {-40, 40, 0}}}, 0);
  if (!has_ball) return scene;
  Mesh ball;
  ball.AddBlob({0, 0, 0}, {0.3, 0.3, 0.3}, 0, 1, 0, 24);
  scene.movers.shapes.push_back(ball);
  scene.movers.movers.push_back(
      {0, [](double time) {
         return Rigid3{Eigen::Quaterniond::Identity(), {2 + kSpeed * (time - 3), 5, 0.35}};
       }});
  return scene;
}

class Movers : public testing::Test {
 protected:
  static RenderedImage Take(const Scene& scene, const Rig& rig, double time) {
    const Renderer renderer(scene, rig, kHalfFieldOfView);
    Shot shot;
    shot.camera = 1;
    shot.world_from_body = [](double) { return Rigid3(); };
    shot.exposure = 0.004;
    shot.semantics = Semantics::kDrivable;
    shot.time = time;
    return renderer.Render(shot);
  }

  static Rig RollingRig() {
    RigOptions options;
    options.line_delay = 5e-5;
    return MakeSimulatedRig(options, 4);
  }
};

TEST_F(Movers, AreSeenWhereTheyAreWhenTheirRowIsExposed) {
  const Scene scene = BallWorld(true);
  const Rig rig = RollingRig();
  const RigCamera& camera = rig.cameras[1];
  for (const double time : {2.93, 3.0, 3.06}) {
    const cv::Mat radiance = Take(scene, rig, time).radiance;
    double offset = 0;
    std::optional<Eigen::Vector2d> expected;
    for (int i = 0; i < 4; ++i) {
      const Rigid3 world_from_ball = scene.movers.movers[0].world_from_mover(time + offset);
      expected =
          camera.model.Project(camera.body_from_camera.Inverse() * world_from_ball.translation);
      ASSERT_TRUE(expected);
      offset = camera.line_delay * (expected->y() - (camera.model.height() - 1) / 2.0);
    }
    // The ball is lit from above, but for its outline that does not matter: every white pixel
    // counts the same.
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int count = 0;
    const int column = static_cast<int>(expected->x()), row = static_cast<int>(expected->y());
    for (int y = row - 20; y <= row + 20; ++y)
      for (int x = column - 20; x <= column + 20; ++x)
        if (radiance.at<cv::Vec3f>(y, x)[1] > 0.012f) {
          sum += Eigen::Vector2d(x, y);
          ++count;
        }
    ASSERT_GT(count, 60) << time;
    // A fisheye draws a ball a little lopsided; standing still for the rows' delay would be 4 px
    // off.
    EXPECT_LT((sum / count - *expected).norm(), 1) << time;
  }
}

TEST_F(Movers, AreNoDrivableGround) {
  const Rig rig = RollingRig();
  const cv::Mat without = Take(BallWorld(false), rig, 3).mask,
                with = Take(BallWorld(true), rig, 3).mask;

  EXPECT_GT(cv::countNonZero(without) - cv::countNonZero(with), 60);
  EXPECT_EQ(cv::countNonZero(with & ~without), 0);
}

TEST_F(Movers, HideSkyFromTheGroundBelowThemOnlyNearby) {
  Scene scene = BallWorld(true);
  scene.movers.movers[0].half_size = {0.3f, 0.3f};
  MoverScene movers(scene.movers);
  movers.PlaceAt(2.99, 3.01, {0, 0, 0});

  EXPECT_LT(movers.Ambient({2, 5, 0}), 0.9f);
  EXPECT_GT(movers.Ambient({2, 8, 0}), 0.99f);
  movers.PlaceAt(100, 100.1, {0, 0, 0});
  EXPECT_TRUE(movers.empty()) << "nothing is placed far out of sight";
}

}  // namespace
}  // namespace parkade::simulator
