#include "mapping/observation/path_seeds.h"

#include <gtest/gtest.h>

#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

TEST(PathSeeds, AreWhereTheCarWillDriveAndNotBesideIt) {
  const Rig rig = MakeTestRig();
  const WheelbaseFootprint contact = WheelbaseFootprint::Of(rig);
  const Trajectory trajectory = DriveAlong(MakeLot(), {-15, 0, 0}, 0, {{20, 0}}, rig);
  const GroundGrid grid = MakeGroundGrid(rig.cameras[0], rig.cameras[0].body_from_camera, contact);

  const std::vector<std::uint8_t> seeds =
      FindPathSeeds(grid, trajectory, trajectory.span().begin, Rigid3{}, contact);

  int ahead = 0;
  for (size_t i = 0; i < seeds.size(); ++i) {
    const Eigen::Vector2f point = grid.cells[i].point_in_ground;
    if (!grid.cells[i].is_visible) continue;
    EXPECT_FALSE(seeds[i] && point.x() > 4 && std::abs(point.y()) > 1.0F) << point.transpose();
    if (point.x() > 4 && point.x() < 9 && std::abs(point.y()) < 0.6F) ahead += seeds[i];
  }
  EXPECT_GT(ahead, 100);
}

TEST(PathSeeds, TheRearCameraSeesWhereTheCarCameFrom) {
  const Rig rig = MakeTestRig();
  const WheelbaseFootprint contact = WheelbaseFootprint::Of(rig);
  const Trajectory trajectory = DriveAlong(MakeLot(), {-15, 0, 0}, 0, {{20, 0}}, rig);
  const GroundGrid grid = MakeGroundGrid(rig.cameras[1], rig.cameras[1].body_from_camera, contact);

  const auto count = [&](Timestamp time) {
    const std::vector<std::uint8_t> seeds =
        FindPathSeeds(grid, trajectory, time, Rigid3{}, contact);
    int behind = 0;
    for (size_t i = 0; i < seeds.size(); ++i)
      behind += seeds[i] && grid.cells[i].point_in_ground.x() < -2;
    return behind;
  };

  EXPECT_EQ(count(trajectory.span().begin), 0);
  EXPECT_GT(count(trajectory.span().end), 100);
}

TEST(PathSeeds, OutsideOfTheTrajectoryThereAreNone) {
  const Rig rig = MakeTestRig();
  const Trajectory trajectory = DriveAlong(MakeLot(), {-15, 0, 0}, 0, {{2, 0}}, rig);
  const GroundGrid grid =
      MakeGroundGrid(rig.cameras[0], rig.cameras[0].body_from_camera, WheelbaseFootprint::Of(rig));

  const auto seeds = FindPathSeeds(grid, trajectory, trajectory.span().end + 5, Rigid3{},
                                   WheelbaseFootprint::Of(rig));

  EXPECT_EQ(std::count(seeds.begin(), seeds.end(), 1), 0);
}

}  // namespace
}  // namespace parkade
