#include "mapping/ground/keyframe_picker.h"

#include <gtest/gtest.h>

#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

Trajectory StraightDrive(double length) {
  const SyntheticScene scene = MakeLot();
  return DriveAlong(scene, {-15, 0, 0}, 0, {{length, 0}}, MakeTestRig());
}

int CountWanted(const Trajectory& trajectory, int camera, KeyframePicker& picker) {
  int count = 0;
  for (const TrajectoryState& state : trajectory.states())
    count += picker.Wants(camera, state.time);
  return count;
}

TEST(KeyframePicker, TakesOneImagePerStretchOfTravel) {
  const Trajectory trajectory = StraightDrive(10);
  KeyframePicker picker(trajectory, 1, 1.0, 0.2);

  EXPECT_NEAR(CountWanted(trajectory, 0, picker), 10, 1);
}

TEST(KeyframePicker, StretchesAreAsNearToTheirLengthAsTheRateOfImagesAllows) {
  constexpr double kStep = 0.2, kStretch = 1.13;  // [m]
  std::vector<TrajectoryState> states(1001);
  for (size_t i = 0; i < states.size(); ++i) {
    states[i].time = TimestampFromSeconds(0.05 * static_cast<double>(i));
    states[i].world_from_body.translation.x() = kStep * static_cast<double>(i);
  }
  const Trajectory trajectory(states);
  for (const int every : {1, 2, 3, 4, 5, 9}) {
    KeyframePicker picker(trajectory, 1, kStretch, 0.2);
    int count = 0;
    for (size_t i = 0; i < states.size(); i += static_cast<size_t>(every))
      count += picker.Wants(0, states[i].time);
    const double between = kStep * every,
                 nearest = between * std::max(1.0, std::round(kStretch / between));
    EXPECT_NEAR(200.0 / count, nearest, 0.02) << "an image every " << between << " m";
  }
}

TEST(KeyframePicker, CamerasAreChosenEachOnItsOwn) {
  const Trajectory trajectory = StraightDrive(10);
  KeyframePicker picker(trajectory, 2, 1.0, 0.2);

  const int first = CountWanted(trajectory, 0, picker);

  EXPECT_EQ(CountWanted(trajectory, 1, picker), first);
}

TEST(KeyframePicker, TurningOnTheSpotCountsToo) {
  std::vector<TrajectoryState> states(91);
  for (size_t i = 0; i < states.size(); ++i) {
    states[i].time = TimestampFromSeconds(0.1 * static_cast<double>(i));
    states[i].world_from_body.rotation =
        Eigen::AngleAxisd(static_cast<double>(i) * M_PI / 180, Eigen::Vector3d::UnitZ());
  }
  const Trajectory trajectory(states);
  KeyframePicker picker(trajectory, 1, 1.0, 9.99 * M_PI / 180);

  EXPECT_EQ(CountWanted(trajectory, 0, picker), 10);
}

TEST(KeyframePicker, AtStandstillOnlyTheFirstIsTaken) {
  std::vector<TrajectoryState> states(500);
  for (size_t i = 0; i < states.size(); ++i) {
    states[i].time = TimestampFromSeconds(0.1 * static_cast<double>(i));
    states[i].world_from_body.translation.x() =
        0.02 * std::sin(static_cast<double>(i));  // noise of the odometry
  }
  const Trajectory trajectory(states);
  KeyframePicker picker(trajectory, 1, 1.0, 0.2);

  EXPECT_EQ(CountWanted(trajectory, 0, picker), 1);
}

TEST(KeyframePicker, TheMaskOfAChosenImageIsWantedToo) {
  const Trajectory trajectory = StraightDrive(10);
  KeyframePicker picker(trajectory, 1, 1.0, 0.2);
  const Timestamp begin = trajectory.span().begin;

  EXPECT_TRUE(picker.Wants(0, begin));
  EXPECT_TRUE(picker.Wants(0, begin));
  EXPECT_FALSE(picker.Wants(0, begin + 0.1));
  EXPECT_FALSE(picker.Wants(0, begin + 0.1));
}

TEST(KeyframePicker, OutsideOfTheTrajectoryNothingIsWanted) {
  const Trajectory trajectory = StraightDrive(3);
  KeyframePicker picker(trajectory, 1, 1.0, 0.2);

  EXPECT_FALSE(picker.Wants(0, trajectory.span().begin - 1));
  EXPECT_FALSE(picker.Wants(0, trajectory.span().end + 1));
}

}  // namespace
}  // namespace parkade
