#include "tests/simulator/vehicle/camera_clock.h"

#include <gtest/gtest.h>

#include <map>

namespace parkade::simulator {
namespace {

Motion Standing(double duration) {
  return Motion([](double) { return PoseVector(PoseVector::Zero()); }, duration, 0.5);
}

TEST(ScheduleFrames, CamerasKeepTheirRateButNeverFireTogether) {
  const auto frames = ScheduleFrames(Standing(60), 4, {.rate = 10, .drop_probability = 0}, 0.1, 2);

  std::map<size_t, std::vector<Timestamp>> times;
  for (size_t i = 0; i < frames.size(); ++i) {
    times[frames[i].camera].push_back(frames[i].time);
    if (i > 0) {
      EXPECT_GE(frames[i].time, frames[i - 1].time);
    }
  }
  ASSERT_EQ(times.size(), 4u);
  for (const auto& [camera, stamps] : times) {
    EXPECT_NEAR(static_cast<double>(stamps.size()), 598, 2);
    for (size_t i = 1; i < stamps.size(); ++i) EXPECT_NEAR(stamps[i] - stamps[i - 1], 0.1, 0.0049);
    if (camera > 0) {
      EXPECT_GT(std::abs(std::remainder(stamps[0] - times[0][0], 0.1)), 1e-3);
    }
  }
}

TEST(ScheduleFrames, LosesTheShareOfImagesAskedForAndKeepsTheOthersWhereTheyAre) {
  const auto all = ScheduleFrames(Standing(200), 1, {.drop_probability = 0}, 0.1, 2),
             some = ScheduleFrames(Standing(200), 1, {.drop_probability = 0.2}, 0.1, 2);

  EXPECT_NEAR(static_cast<double>(some.size()) / static_cast<double>(all.size()), 0.8, 0.03);
  size_t next = 0;
  for (const ScheduledFrame& frame : some) {
    while (next < all.size() && all[next].time != frame.time) ++next;
    ASSERT_LT(next, all.size());
  }
}

}  // namespace
}  // namespace parkade::simulator
