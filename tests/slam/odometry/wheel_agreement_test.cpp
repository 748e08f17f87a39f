#include "slam/odometry/wheel_agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace parkade {
namespace {

Timestamp At(double seconds) { return Timestamp{1'700'000'000'000'000'000} + seconds; }

double SpeedAt(double seconds) { return 3 + 2 * std::sin(0.7 * seconds); }

/// A car on a circle, which speeds up and slows down.
Trajectory Drive() {
  std::vector<TrajectoryState> states;
  double heading = 0;
  for (double t = 0; t <= 20; t += 0.05) {
    heading += 0.05 * 0.1 * SpeedAt(t);
    const Eigen::Quaterniond rotation = ExpSo3({0, 0, heading});
    states.push_back({.time = At(t),
                      .world_from_body = {rotation, Eigen::Vector3d::Zero()},
                      .velocity_in_world = rotation * Eigen::Vector3d(SpeedAt(t), 0, 0)});
  }
  return Trajectory(std::move(states));
}

WheelAgreement Compare(const std::function<double(double seconds)>& reported) {
  std::vector<WheelSample> wheels;
  for (double t = 0.01; t < 20; t += 0.02) wheels.push_back({At(t), reported(t), 0});
  return CompareWheels(Drive(), wheels);
}

TEST(WheelAgreement, FitsWheelsOfWornTiresWithSomeSlip) {
  const WheelAgreement agreement =
      Compare([](double t) { return (std::fmod(t, 5) < 0.5 ? 1.6 : 1.0) * 0.93 * SpeedAt(t); });
  EXPECT_TRUE(agreement.Fits()) << agreement.scale << " " << agreement.error;
  EXPECT_NEAR(agreement.scale, 1 / 0.93, 1e-3);
}

TEST(WheelAgreement, NamesWhatWheelsLookLike) {
  const auto doubt = [](const std::function<double(double)>& reported) {
    const WheelAgreement agreement = Compare(reported);
    return agreement.Fits() ? "" : agreement.Doubt();
  };
  EXPECT_NE(doubt([](double) { return 0.0; }).find("say 0 m/s while"), std::string::npos);
  EXPECT_NE(doubt([](double t) { return 3.6 * SpeedAt(t); }).find("in km/h"), std::string::npos);
  EXPECT_NE(doubt([](double t) { return 3.6 * SpeedAt(t); }).find("wheel_scale: 0.2778"),
            std::string::npos);
  EXPECT_NE(doubt([](double t) { return -SpeedAt(t); }).find("sign reversed"), std::string::npos);
  EXPECT_NE(doubt([](double t) { return 0.5 * SpeedAt(t); }).find("wheel_scale: 2 "),
            std::string::npos);
  EXPECT_NE(doubt([](double t) {
              return SpeedAt(t) * std::cos(0.3 * t * SpeedAt(t));
            }).find("contradict the motion"),
            std::string::npos);
}

TEST(WheelAgreement, KnowsSpeedsThatAreOffALittleForLong) {
  const auto changed = Compare([](double t) { return (t < 10 ? 1 : 1.08) * SpeedAt(t); });
  EXPECT_FALSE(changed.Fits());
  EXPECT_NE(changed.Doubt().find("contradict the motion"), std::string::npos) << changed.Doubt();
  EXPECT_FALSE(Compare([](double t) { return 0.5 + SpeedAt(t); }).Fits());

  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.1);
  const auto noisy = Compare([&](double t) { return SpeedAt(t) + noise(random); });
  EXPECT_TRUE(noisy.Fits()) << noisy.lasting_error << " m/s: noise does not last";
}

TEST(WheelAgreement, KnowsADelay) {
  const WheelAgreement late = Compare([](double t) { return SpeedAt(t - 0.3); });
  EXPECT_FALSE(late.Fits());
  EXPECT_NEAR(late.delay, 0.3, 0.021);
  EXPECT_NE(late.Doubt().find("are stamped 0.3 s too late"), std::string::npos) << late.Doubt();
  EXPECT_TRUE(Compare([](double t) { return SpeedAt(t - 0.04); }).Fits());
}

TEST(WheelAgreement, TellsNothingOfACarThatStands) {
  EXPECT_TRUE(CompareWheels(Drive(), {}).Fits());
  EXPECT_TRUE(CompareWheels(Drive(), {{At(1), 0, 0}, {At(2), 0, 0}}).Fits());
}

}  // namespace
}  // namespace parkade
