#include "tests/simulator/sensors/wheel_sensor.h"

#include <gtest/gtest.h>

#include "tests/simulator/common/drive_clock.h"

namespace parkade::simulator {
namespace {

Motion Straight(double duration, double speed) {
  return Motion([=](double t) { return PoseVector(PoseVector(speed * t, 0, 0, 0, 0, 0)); },
                duration);
}

TEST(SimulateWheels, SpeedIsOffByTheScaleErrorAndIntegratesToTheWay) {
  SensorOptions options;
  options.wheel_scale_error = 0.01;
  const auto samples = SimulateWheels(Straight(60, 3), options, 5);

  double way = 0;
  for (size_t i = 1; i < samples.size(); ++i)
    way += samples[i].forward_speed * (samples[i].time - samples[i - 1].time);
  EXPECT_NEAR(way / (3 * (samples.back().time - samples.front().time)), 1.01, 3e-4);
}

TEST(SimulateWheels, NoiseHasItsNominalSizeAndNoMemory) {
  const double speed = 3, sigma = 0.012 + 0.002 * speed;
  SensorOptions options;
  options.wheel_scale_error = 0;
  const auto samples = SimulateWheels(Straight(200, speed), options, 6);

  double sum_squares = 0, sum_products = 0;
  for (size_t i = 1; i < samples.size(); ++i) {
    const double error = (samples[i].forward_speed - speed) / sigma;
    sum_squares += error * error;
    sum_products += error * (samples[i - 1].forward_speed - speed) / sigma;
  }
  const double count = static_cast<double>(samples.size() - 1);
  EXPECT_NEAR(sum_squares / count, 1, 0.04);  // 4 sigma of a chi-square of 20000
  EXPECT_NEAR(sum_products / count, 0, 0.03);
}

TEST(SimulateWheels, StandingWheelsGiveExactlyZero) {
  const auto samples = SimulateWheels(Straight(2, 0), {}, 5);
  ASSERT_FALSE(samples.empty());
  for (const WheelSample& sample : samples) {
    EXPECT_EQ(sample.forward_speed, 0);
    EXPECT_EQ(sample.yaw_rate, 0);
  }
}

TEST(SimulateWheels, ASlipIsThereWhileItLastsAndNowhereElse) {
  const Motion motion = Straight(20, 4);
  const auto plain = SimulateWheels(motion, {}, 5),
             slipping = SimulateWheels(motion, {}, 5, {{8, 10, 0.5}});

  ASSERT_FALSE(plain.empty());
  ASSERT_EQ(plain.size(), slipping.size());
  for (size_t i = 0; i < plain.size(); ++i) {
    const double time = plain[i].time - DriveEpoch(5),
                 more = slipping[i].forward_speed - plain[i].forward_speed;
    if (time < 8 || time > 10) {
      EXPECT_EQ(more, 0) << time;
    } else if (time > 8.1 && time < 9.9) {
      EXPECT_NEAR(more, 0.5 * 4 * 1.005, 1e-9) << time;
    }
  }
}

TEST(PlanSlips, WheelsSlipWhenTheCarAcceleratesHardOnly) {
  SensorOptions options;
  options.wheel_slips = 30;
  const Motion swaying(
      [](double t) { return PoseVector(PoseVector(8 * t + 6 * std::sin(0.6 * t), 0, 0, 0, 0, 0)); },
      300);

  const std::vector<WheelSlip> slips = PlanSlips(swaying, options, 2);
  EXPECT_GT(slips.size(), 20u);
  for (const WheelSlip& slip : slips) {
    const double acceleration = -6 * 0.36 * std::sin(0.6 * slip.begin);
    EXPECT_GT(std::abs(acceleration), 0.99);
    EXPECT_GT(acceleration * slip.ratio, 0);
  }
  EXPECT_TRUE(PlanSlips(Straight(300, 5), options, 2).empty());
}

}  // namespace
}  // namespace parkade::simulator
