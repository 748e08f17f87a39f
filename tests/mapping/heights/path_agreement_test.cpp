#include "mapping/heights/path_agreement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace parkade {
namespace {

constexpr double kRadius = 8.0;    // [m] of the round
constexpr double kDuration = 40;   // [s], two rounds
constexpr double kFrequency = 10;  // [Hz]

using Change = std::function<Rigid3(double)>;

Rigid3 Turned(double angle, const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ()) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), Eigen::Vector3d::Zero()};
}

/// Two rounds; `change` moves the poses, as a function of time.
Trajectory Rounds(const Change& change) {
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= kDuration * kFrequency; ++i) {
    const double t = i / kFrequency, angle = 4 * std::numbers::pi * t / kDuration;
    TrajectoryState state;
    state.time = TimestampFromSeconds(100 + t);
    state.world_from_body =
        change(t) * Turned(angle) * Rigid3{Eigen::Quaterniond::Identity(), {0, -kRadius, 0}};
    states.push_back(state);
  }
  return Trajectory(std::move(states));
}

Trajectory AsItWas() {
  return Rounds([](double) { return Rigid3{}; });
}

bool HoldAlong(std::span<const TimedPose> before, const Trajectory& now) {
  const PathAgreement agreement(before, now);
  const std::vector<Eigen::Vector3d> places = agreement.Places();
  return std::all_of(places.begin(), places.end(),
                     [&](const Eigen::Vector3d& place) { return agreement.HoldsAt(place); });
}

bool HoldAfter(const Change& change) { return HoldAlong(SparsePoses(AsItWas()), Rounds(change)); }

TEST(PathAgreement, HoldsAsLongAsPosesNearEachOtherLieAsTheyDid) {
  EXPECT_TRUE(HoldAfter([](double) { return Rigid3{}; }));
  EXPECT_TRUE(HoldAfter([](double) {
    return Rigid3{Eigen::Quaterniond::Identity(), {30, -20, 1}} * Turned(0.7);
  })) << "all of it may lie elsewhere";
  EXPECT_TRUE(HoldAfter([](double t) {
    return Rigid3{Eigen::Quaterniond::Identity(), {0, 0, 0.002 * t / kDuration}};
  })) << "two rounds come apart by 1 mm";
  EXPECT_FALSE(HoldAfter([](double t) {
    return Rigid3{Eigen::Quaterniond::Identity(), {0, 0, 0.01 * t / kDuration}};
  })) << "by 5 mm";
  EXPECT_FALSE(HoldAfter([](double t) {
    return Rigid3{Eigen::Quaterniond::Identity(), {t > 20 ? 0.004 : 0, 0, 0}};
  })) << "a step";
  EXPECT_FALSE(HoldAfter([](double t) {
    return Turned(0.001 * t / kDuration, Eigen::Vector3d::UnitX());
  })) << "a twist by 0.5 mrad from one round to the next";
}

/// Out along one aisle, and back along the next one, 16 m apart; that one lies higher by `lift`
/// [m], the way to it goes up steadily.
Trajectory Aisles(double lift) {
  constexpr double kLength = 60, kApart = 16, kStep = 0.25;  // [m]
  constexpr double kWay = 2 * kLength + kApart;
  std::vector<TrajectoryState> states;
  for (double s = 0; s <= kWay; s += kStep) {
    const double across = std::clamp(s - kLength, 0.0, kApart);
    TrajectoryState state;
    state.time = TimestampFromSeconds(100 + s);
    state.world_from_body =
        Rigid3{Eigen::Quaterniond::Identity(),
               {s < kLength ? s : std::min(kLength, kWay - s), across, lift * s / kWay}} *
        Turned(std::numbers::pi * across / kApart);
    states.push_back(state);
  }
  return Trajectory(std::move(states));
}

TEST(PathAgreement, HoldsNotWhereTheNextAisleMoved) {
  const std::vector<TimedPose> before = SparsePoses(Aisles(0));
  EXPECT_TRUE(HoldAlong(before, Aisles(0.003)));
  EXPECT_FALSE(HoldAlong(before, Aisles(0.015))) << "views from both saw the ground between them";
}

TEST(PathAgreement, HoldsNotWhereAPoseIsMissing) {
  const std::vector<TimedPose> before = SparsePoses(AsItWas());
  std::vector<TrajectoryState> states = AsItWas().states();
  states.resize(states.size() / 2);
  EXPECT_FALSE(HoldAlong(before, Trajectory(std::move(states))));
  EXPECT_TRUE(HoldAlong({}, AsItWas()));
}

TEST(SparsePoses, AreTwoMetersApart) {
  const std::vector<TimedPose> poses = SparsePoses(AsItWas());
  EXPECT_NEAR(static_cast<double>(poses.size()), 4 * std::numbers::pi * kRadius / 2, 7);
  EXPECT_EQ(poses.back().time, AsItWas().span().end);
}

TEST(SparsePoses, CloserWhereTheCarTurns) {
  const Trajectory on_the_spot = Rounds([](double t) {
    const double angle = 4 * std::numbers::pi * t / kDuration;
    return Turned(angle) * Rigid3{Eigen::Quaterniond::Identity(), {0, kRadius, 0}} * Turned(-angle);
  });
  EXPECT_GT(SparsePoses(on_the_spot).size(), 40U);
}

}  // namespace
}  // namespace parkade
