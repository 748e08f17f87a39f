#include "server/http/pace_meter.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using namespace std::chrono_literals;

/// A client that is waited for all the time.
class Waiting : public testing::Test {
 protected:
  /// Lets a second pass, at whose end `bytes` come.
  void PassSecond(std::int64_t bytes) {
    meter_.BeginWaiting(now_);
    now_ += 1s;
    meter_.EndWaiting(now_);
    meter_.Count(bytes);
  }

  PaceMeter meter_;
  PaceMeter::Clock::time_point now_{};
};

TEST_F(Waiting, IsMeasuredOverTheLastSeconds) {
  EXPECT_FALSE(meter_.PaceOver(2s, now_));
  PassSecond(1000);
  EXPECT_FALSE(meter_.PaceOver(2s, now_));
  PassSecond(1000);
  EXPECT_DOUBLE_EQ(meter_.PaceOver(2s, now_).value(), 1000);
  for (int i = 0; i < 20; ++i) PassSecond(3000);
  EXPECT_DOUBLE_EQ(meter_.PaceOver(2s, now_).value(), 4500);  // the second that begins has its own
  EXPECT_DOUBLE_EQ(meter_.PaceOver(10s, now_).value(), 3300);
}

TEST_F(Waiting, GoesOnWhileItLasts) {
  meter_.BeginWaiting(now_);
  EXPECT_FALSE(meter_.IsTooSlow(now_ + 9s));
  EXPECT_TRUE(meter_.IsTooSlow(now_ + 10s));
}

TEST_F(Waiting, IsNotTooLongForWhoSendsEnough) {
  for (int i = 0; i < 60; ++i) {
    PassSecond(9000);
    EXPECT_FALSE(meter_.IsTooSlow(now_)) << i;
  }
}

TEST_F(Waiting, IsTooLongThoughMuchCameBefore) {
  meter_.Count(1'000'000'000);
  int seconds = 0;
  while (!meter_.IsTooSlow(now_) && ++seconds < 60) PassSecond(1);
  EXPECT_EQ(seconds, 11);
}

TEST_F(Waiting, IsAllThatCounts) {
  PassSecond(1);
  now_ += 1h;  // of work of our own
  PassSecond(1);
  EXPECT_FALSE(meter_.IsTooSlow(now_));
  for (int i = 0; i < 10; ++i) PassSecond(1);
  EXPECT_TRUE(meter_.IsTooSlow(now_));
  meter_.Reset();
  EXPECT_FALSE(meter_.IsTooSlow(now_));
}

}  // namespace
}  // namespace parkade
