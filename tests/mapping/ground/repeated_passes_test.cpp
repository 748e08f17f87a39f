#include "mapping/ground/repeated_passes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mapping/ground/keyframe_picker.h"
#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

constexpr double kStep = 0.1;  // [m] between states, and [s]

/// A car on a way that is given by where it is and where it heads after so much travel.
template <typename PoseAfter>
Trajectory Drive(double length, const PoseAfter& pose_after) {
  std::vector<TrajectoryState> states(static_cast<size_t>(length / kStep));
  for (size_t i = 0; i < states.size(); ++i) {
    const double traveled = kStep * static_cast<double>(i);
    states[i].time = TimestampFromSeconds(traveled);
    const auto [place, heading] = pose_after(traveled);
    states[i].world_from_body = {ExpSo3(heading * Eigen::Vector3d::UnitZ()), place};
  }
  return Trajectory(states);
}

constexpr double kRound = 60;  // [m]

/// Rounds of a circle, each `rise` [m] above the one before and `aside` [m] wider.
Trajectory Rounds(int count, double rise = 0, double aside = 0) {
  return Drive(count * kRound, [=](double traveled) {
    const double angle = traveled / kRound * 2 * std::numbers::pi, rounds = traveled / kRound;
    const double radius = kRound / (2 * std::numbers::pi) + aside * rounds;
    return std::pair(
        Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), rise * rounds),
        angle + std::numbers::pi / 2);
  });
}

double RepeatedShare(const RepeatedPasses& repeated, double begin, double end) {
  const int all = static_cast<int>(std::lround((end - begin) / kStep));
  int count = 0;
  for (int i = 0; i < all; ++i)
    count += repeated.Contains(TimestampFromSeconds(begin + (i + 0.5) * kStep));
  return static_cast<double>(count) / all;
}

TEST(RepeatedPasses, TheFirstAndTheLastOfARoundAreNone) {
  const RepeatedPasses repeated(Rounds(5), 2);

  EXPECT_LT(RepeatedShare(repeated, 0, kRound), 0.02);
  EXPECT_GT(RepeatedShare(repeated, kRound, 4 * kRound), 0.97);
  EXPECT_LT(RepeatedShare(repeated, 4 * kRound, 5 * kRound), 0.02);
}

TEST(RepeatedPasses, AsManyAsAskedForAreKept) {
  const Trajectory rounds = Rounds(6);

  EXPECT_EQ(RepeatedShare(RepeatedPasses(rounds, 0), 0, 6 * kRound), 0);
  EXPECT_NEAR(RepeatedShare(RepeatedPasses(rounds, 1), 0, 6 * kRound), 5.0 / 6, 0.02);
  EXPECT_NEAR(RepeatedShare(RepeatedPasses(rounds, 3), 0, 6 * kRound), 3.0 / 6, 0.02);
  EXPECT_LT(RepeatedShare(RepeatedPasses(rounds, 6), 0, 6 * kRound), 0.01);
  EXPECT_GT(RepeatedShare(RepeatedPasses(rounds, 3), 0, 3 * kRound), 0.6) << "last ones come first";
}

TEST(RepeatedPasses, OtherDecksAndLanesAreOtherPlaces) {
  EXPECT_EQ(RepeatedShare(RepeatedPasses(Rounds(5, 2.7), 2), 0, 5 * kRound), 0);
  EXPECT_EQ(RepeatedShare(RepeatedPasses(Rounds(5, 0, 1.2), 2), 0, 5 * kRound), 0);
  EXPECT_GT(RepeatedShare(RepeatedPasses(Rounds(5, 0, 0.1), 2), 0, 5 * kRound), 0.5);
}

TEST(RepeatedPasses, ThereAndBackAreTwoDirections) {
  const Trajectory forth_and_back = Drive(100, [](double traveled) {
    const bool is_back = std::fmod(traveled, 50) > 25;
    const double at = std::fmod(traveled, 25);
    return std::pair(Eigen::Vector3d(is_back ? 25 - at : at, 0, 0),
                     is_back ? std::numbers::pi : 0.0);
  });

  EXPECT_LT(RepeatedShare(RepeatedPasses(forth_and_back, 2), 0, 100), 0.02);
  EXPECT_GT(RepeatedShare(RepeatedPasses(forth_and_back, 1), 0, 50), 0.9);
}

TEST(RepeatedPasses, StandingIsNoRepetition) {
  const Trajectory drive = Drive(60, [](double traveled) {
    const double x = traveled < 10 ? traveled : std::max(10.0, traveled - 40);
    return std::pair(Eigen::Vector3d(x, 0, 0), 0.0);
  });

  EXPECT_EQ(RepeatedShare(RepeatedPasses(drive, 1), 0, 60), 0);
}

TEST(RepeatedPasses, NothingIsRepeatedOutsideOfTheDrive) {
  const RepeatedPasses repeated(Rounds(3), 2);

  EXPECT_FALSE(repeated.Contains(TimestampFromSeconds(-1)));
  EXPECT_FALSE(RepeatedPasses(Trajectory(), 2).Contains(TimestampFromSeconds(1)));
}

TEST(RepeatedPasses, NoImagesOfThemAreChosen) {
  const Trajectory rounds = Rounds(5);
  const auto count = [&](const RepeatedPasses* repeated) {
    KeyframePicker picker(rounds, 1, 1.2, 0.2, repeated);
    int wanted = 0;
    for (const TrajectoryState& state : rounds.states()) wanted += picker.Wants(0, state.time);
    return wanted;
  };
  const RepeatedPasses repeated(rounds, 2);

  EXPECT_NEAR(count(&repeated), 0.4 * count(nullptr), 3);
}

}  // namespace
}  // namespace parkade
