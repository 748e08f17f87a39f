#include "tests/simulator/render/lens_flare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "tests/simulator/render/renderer.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

Shot FlareShot(const Rig& rig, const Eigen::Vector3d& axis, double flare) {
  // The first camera looks along `axis`, high above the lot, where nothing hides the sun.
  const Rigid3 body_from_camera = rig.cameras[0].body_from_camera;
  const Eigen::Quaterniond look =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis);
  const Rigid3 world_from_body =
      Rigid3{look, Eigen::Vector3d(20, 15, 60)} * body_from_camera.Inverse();
  Shot shot;
  shot.world_from_body = [=](double) { return world_from_body; };
  shot.flare = flare;
  return shot;
}

class Flares : public testing::Test {
 protected:
  static cv::Mat Added(const SceneOptions& options, double turned) {
    const Scene scene = BuildScene("lot", options);
    const Rig rig = MakeSimulatedRig({.width = 160, .height = 100}, 5);
    const Renderer renderer(scene, rig, kHalfFieldOfView);
    const Eigen::Vector3d sun = scene.sky.sun_direction().cast<double>(),
                          axis = Eigen::AngleAxisd(turned, sun.unitOrthogonal()) * sun;
    return renderer.Render(FlareShot(rig, axis, 1)).radiance -
           renderer.Render(FlareShot(rig, axis, 0)).radiance;
  }
  static SceneOptions Options(const std::string& weather) {
    return {.seed = 5, .ground_texel = 0.1, .weather = weather, .has_own_car = false};
  }
};

TEST_F(Flares, AreBrightestAtTheSunAndOppositeToItHaveGhosts) {
  const cv::Mat light = Added(Options("dry"), 0.6);
  cv::Mat green;
  cv::extractChannel(light, green, 1);
  cv::Point brightest;
  double most = 0;
  cv::minMaxLoc(green, nullptr, &most, nullptr, &brightest);
  const cv::Point middle(80, 50), sun = brightest - middle;
  EXPECT_NEAR(std::hypot(sun.x, sun.y), 0.6 / 1.64 * 80, 12) << "where the sun is";
  const auto at = [&](float along) {
    return green.at<float>(
        middle.y + static_cast<int>(std::lround(along * static_cast<float>(sun.y))),
        middle.x + static_cast<int>(std::lround(along * static_cast<float>(sun.x))));
  };
  EXPECT_GT(at(-0.35f), 2 * at(-0.1f)) << "a ghost";
  EXPECT_GT(most, 20 * at(-0.1f)) << "the veil";
}

TEST_F(Flares, NeedASunInFrontOfTheLens) {
  EXPECT_EQ(cv::norm(Added(Options("dusk"), 0.6)), 0);
  EXPECT_EQ(cv::norm(Added(Options("overcast"), 0.6)), 0);
  EXPECT_EQ(cv::norm(Added(Options("dry"), 2)), 0) << "behind the lens";
}

}  // namespace
}  // namespace parkade::simulator
