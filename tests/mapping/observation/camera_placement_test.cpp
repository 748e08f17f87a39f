#include "mapping/observation/camera_placement.h"

#include <gtest/gtest.h>

#include <functional>

namespace parkade {
namespace {

std::vector<CameraPlacement> Two() {
  CameraPlacement front, left;
  front.body_from_camera.translation = {3.6, 0, 0.7};
  left.body_from_camera = {Eigen::Quaterniond(Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitZ())),
                           {2, 1, 1}};
  return {front, left};
}

bool SeeAlikeAfter(const std::function<void(CameraPlacement&)>& change) {
  std::vector<CameraPlacement> now = Two();
  change(now[1]);
  return SeeAlike(Two(), now);
}

TEST(SeeAlike, AsLongAsCamerasHardlyMoved) {
  const auto turn_by = [](double angle) {
    return [angle](CameraPlacement& camera) {
      camera.body_from_camera.rotation =
          camera.body_from_camera.rotation * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX());
    };
  };
  EXPECT_TRUE(SeeAlikeAfter(turn_by(2.9e-4)));
  EXPECT_FALSE(SeeAlikeAfter(turn_by(3.1e-4)));
  EXPECT_TRUE(SeeAlikeAfter([](auto& c) { c.body_from_camera.translation.z() += 1.9e-3; }));
  EXPECT_FALSE(SeeAlikeAfter([](auto& c) { c.body_from_camera.translation.z() += 2.1e-3; }));
  EXPECT_FALSE(SeeAlikeAfter([](auto& c) { c.time_shift -= 1e-9; }));
  EXPECT_FALSE(SeeAlikeAfter([](auto& c) { c.line_delay += 1e-9; }));
  EXPECT_FALSE(SeeAlike(Two(), std::vector<CameraPlacement>{Two()[0]})) << "one is missing";
}

}  // namespace
}  // namespace parkade
