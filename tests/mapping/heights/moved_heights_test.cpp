#include "mapping/heights/moved_heights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mapping/heights/path_agreement.h"

namespace parkade {
namespace {

constexpr double kLength = 100;  // [m] along x, at 1 m/s

/// A drive straight on; poses beyond `begin` [m] are lifted by `lift` [m].
Trajectory Straight(double begin = 0, double lift = 0) {
  std::vector<TrajectoryState> states;
  for (double x = 0; x <= kLength; x += 0.25) {
    TrajectoryState state;
    state.time = TimestampFromSeconds(100 + x);
    state.world_from_body.translation = {x, 0, x > begin ? lift : 0};
    states.push_back(state);
  }
  return Trajectory(std::move(states));
}

/// A height every meter along the drive, all of one path.
DriveHeights HeightsOf(const Trajectory& path) {
  DriveHeights heights;
  const PoseTies ties(&path);
  for (double x = 0; x <= kLength; ++x)
    heights.swept.push_back(
        ties.Tie({{x, 2, path.At(TimestampFromSeconds(100 + x))->translation.z()}, 1e4, 0.01}));
  heights.along = {{SparsePoses(path), heights.swept.size()}};
  return heights;
}

TEST(FindMovedHeights, HoldWhereThePathDidNotBend) {
  const DriveHeights heights = HeightsOf(Straight());
  EXPECT_EQ(FindMovedHeights(heights, Straight(), {}).worth, HeightsWorth::kHold);
  EXPECT_EQ(FindMovedHeights(heights, Straight(-1, 0.5), {}).worth, HeightsWorth::kHold)
      << "all of it is lifted";
  EXPECT_EQ(FindMovedHeights(heights, Straight(50, 0.002), {}).worth, HeightsWorth::kHold);
}

TEST(FindMovedHeights, AreMeasuredAgainInSquaresThatSeeTheBend) {
  const MovedHeights moved = FindMovedHeights(HeightsOf(Straight()), Straight(50, 0.01), {});
  EXPECT_EQ(moved.worth, HeightsWorth::kSome);
  for (const double x : {40.0, 50.0, 60.0}) EXPECT_TRUE(moved.squares.Has({x, 0, 0})) << x;
  for (const double x : {5.0, 15.0, 90.0}) EXPECT_FALSE(moved.squares.Has({x, 0, 0})) << x;
}

TEST(FindMovedHeights, GroundThatHadNoHeightsMayNowHaveSome) {
  DriveHeights heights = HeightsOf(Straight());
  heights.swept.resize(20);
  heights.along[0].num_swept = 20;
  EXPECT_TRUE(FindMovedHeights(heights, Straight(50, 0.01), {}).squares.Has({50, 0, 0}));
}

TEST(FindMovedHeights, SmallMovesAreHeldAgainstThePathOfEachHeight) {
  DriveHeights heights = HeightsOf(Straight());
  // The first 50 were measured along the path of then, the others along one that was bent since.
  heights.along = {{SparsePoses(Straight()), 50},
                   {SparsePoses(Straight(80, 0.01)), heights.swept.size() - 50}};
  EXPECT_EQ(FindMovedHeights(heights, Straight(80, 0.012), {}).worth, HeightsWorth::kHold);
  const MovedHeights moved = FindMovedHeights(heights, Straight(80, 0.001), {});
  EXPECT_TRUE(moved.squares.Has({80, 0, 0}));
  EXPECT_FALSE(moved.squares.Has({10, 0, 0}));
}

TEST(FindMovedHeights, NoneAreLeftAfterATwistOfAllOrManyMoves) {
  DriveHeights heights = HeightsOf(Straight());
  std::vector<TrajectoryState> twisted = Straight().states();
  for (TrajectoryState& state : twisted)
    state.world_from_body.translation.z() +=
        4e-4 * std::pow(state.world_from_body.translation.x(), 2);
  EXPECT_EQ(FindMovedHeights(heights, Trajectory(twisted), {}).worth, HeightsWorth::kNone);
  heights.along.resize(20, {heights.along[0].path, 0});
  EXPECT_EQ(FindMovedHeights(heights, Straight(50, 0.01), {}).worth, HeightsWorth::kNone);
  EXPECT_EQ(FindMovedHeights({}, Straight(), {}).worth, HeightsWorth::kNone) << "of no path";
}

}  // namespace
}  // namespace parkade
