#include "tests/simulator/motion/drive_path.h"

#include <gtest/gtest.h>

#include "tests/simulator/motion/speed_profile.h"
#include "tests/simulator/motion/suspension.h"

namespace parkade::simulator {
namespace {

/// East, and then backwards around a corner to the north.
DrivePath ThreePointTurn() {
  const Route there({{0, 0, 0}, {30, 0, 0}}, 6);
  const Route back({there.PointAt(there.Length()), {18, 0, 0}, {18, 12, 0}}, 5.5);
  return DrivePath({{there, false}, {back, true}});
}

TEST(DrivePath, TheBodyKeepsItsHeadingWhereTheDirectionChanges) {
  const DrivePath path = ThreePointTurn();
  const PathPoint before = path.At(0, path.legs()[0].route.Length()), after = path.At(1, 0);

  EXPECT_LT((before.position - after.position).norm(), 1e-9);
  EXPECT_NEAR(before.heading, after.heading, 1e-6);
  EXPECT_NEAR(path.At(1, 1).position.x(), before.position.x() - 1, 1e-6);
  // Backing to the north it faces the south.
  EXPECT_NEAR(path.At(1, path.legs()[1].route.Length()).heading, -M_PI / 2, 1e-3);
  EXPECT_GE(path.MinRadius(), 5);
}

TEST(Route, APartHasTheLengthAndThePlacesOfTheWhole) {
  const Route whole({{0, 0, 0}, {30, 0, 0}, {30, 20, 0}}, 6), part = whole.Part(12, 40);

  EXPECT_NEAR(part.Length(), 28, 0.011);
  for (const double distance : {0.0, 10.0, 20.0}) {
    EXPECT_LT((part.Position(distance) - whole.Position(distance + 12)).norm(), 0.011);
    EXPECT_NEAR(part.Heading(distance), whole.Heading(distance + 12), 0.003);
  }
  EXPECT_NEAR(whole.Part(-5, 1e6).Length(), whole.Length(), 1e-9);
}

TEST(SpeedProfile, SpeedRunsSmoothlyThroughZeroWhereTheDirectionChanges) {
  const DrivePath path = ThreePointTurn();
  const SpeedProfile profile(path, {});
  double last_speed = 0, last_acceleration = 0, min_speed = 0, max_step = 0;
  for (double time = 0; time < profile.Duration(); time += 0.01) {
    const double speed = profile.Speed(time), acceleration = profile.Acceleration(time);
    EXPECT_LT(std::abs(speed - last_speed), 0.025) << time;
    max_step = std::max(max_step, std::abs(acceleration - last_acceleration));
    last_speed = speed;
    last_acceleration = acceleration;
    min_speed = std::min(min_speed, speed);
  }

  EXPECT_LT(max_step, 0.25);  // [m/s^2] in 10 ms
  EXPECT_NEAR(min_speed, -1.5, 0.05);
  EXPECT_NEAR(profile.Traveled(profile.Duration()), path.Length(), 0.05);
}

TEST(SpeedProfile, StandsAsLongAndAsOftenAsAskedFor) {
  const DrivePath path({{Route({{0, 0, 0}, {200, 0, 0}}, 6), false}});
  const SpeedProfile profile(path, {.stops = {10, 60}});
  double standing = 0;
  for (double time = 0; time < profile.Duration(); time += 0.01)
    standing += std::abs(profile.Speed(time)) < 1e-6 ? 0.01 : 0;

  EXPECT_NEAR(standing, 10 + 60 + 2 + 1, 4.5);  // pedals take part of each stop
}

TEST(SpeedProfile, ARollingStartBeginsAtItsSpeed) {
  const DrivePath path({{Route({{0, 0, 0}, {100, 0, 0}}, 6), false}});
  const SpeedProfile profile(path, {.rolling_speed = 3});

  EXPECT_NEAR(profile.Speed(0), 3, 0.05);
  EXPECT_NEAR(profile.Traveled(0), 0, 1e-9);
}

TEST(Suspension, LeansAgainstAStepAndSwingsOnce) {
  const Suspension suspension(
      [](double time) {
        return Suspension::Push{time < 1 ? 0.0 : 2.0, 0};
      },
      6, 1);
  double lowest = 0;
  for (double time = 0; time < 6; time += 0.01) lowest = std::min(lowest, suspension.Pitch(time));

  EXPECT_EQ(suspension.Pitch(0.5), 0);
  EXPECT_NEAR(suspension.Pitch(6), -0.008, 1e-4);  // the nose rises when accelerating
  // Overshoot of a second-order system: exp(-pi z / sqrt(1 - z^2)) of the step.
  EXPECT_NEAR(lowest / -0.008, 1 + std::exp(-M_PI * 0.33 / std::sqrt(1 - 0.33 * 0.33)), 0.03);
  EXPECT_EQ(suspension.Roll(3), 0);
}

}  // namespace
}  // namespace parkade::simulator
