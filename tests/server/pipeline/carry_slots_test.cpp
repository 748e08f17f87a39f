#include "server/pipeline/carry_slots.h"

#include <gtest/gtest.h>

#include "tests/server/worlds/straight_drive.h"

namespace parkade {
namespace {

using Eigen::Vector3d;

TEST(CarrySlots, GroundMovesWithTheNearestPose) {
  const Rigid3 turned{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3d::UnitZ())),
                      Vector3d(5, -2, 1)};
  const Trajectory before = StraightDrive(40);
  const std::vector<MovedDrive> drives = {
      {before, before},
      {before.Transformed({Eigen::Quaterniond::Identity(), Vector3d(0, 20, 0)}),
       before.Transformed(turned)}};
  const auto carriage = CarryFrom({10, 18, 0}, drives);
  ASSERT_TRUE(carriage);
  EXPECT_EQ(carriage->drive, 1U);
  EXPECT_LT(
      (carriage->after_from_before * Vector3d(10, 18, 0) - turned * Vector3d(10, -2, 0)).norm(),
      1e-9);
  EXPECT_LT(carriage->spread, 1e-9);
  EXPECT_FALSE(CarryFrom({0, 0, 0}, {}));
}

TEST(CarrySlots, PassesThatMovedApartSaySo) {
  const Trajectory before = StraightDrive(40);
  const std::vector<MovedDrive> drives = {
      {before, before},
      {before, before.Transformed({Eigen::Quaterniond::Identity(), Vector3d(0, 0.8, 0)})}};
  EXPECT_NEAR(CarryFrom({10, 4, 0}, drives)->spread, 0.8, 1e-9);
  const std::vector<MovedDrive> decks = {
      drives[0],
      {before.Transformed({Eigen::Quaterniond::Identity(), Vector3d(0, 0, 3)}), drives[1].after}};
  EXPECT_LT(CarryFrom({10, 4, 0}, decks)->spread, 1e-9) << "another deck's";
}

}  // namespace
}  // namespace parkade
